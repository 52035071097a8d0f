//! Trees of grids of any size, and of networks.

use std::ops::Range;

use bevy::math::Vec3;

use super::*;
use crate::cloth::{Cloth, ClothMaterial, Graph, Layout, Spring, SpringKind, Springs};

impl QuadTree {
    /// The tree of particles that springs join. Bend springs are not paths.
    pub(in crate::hierarchy) fn of_network(rest: &[Vec3], springs: &[Spring]) -> Self {
        let paths = springs
            .iter()
            .filter(|spring| spring.kind != SpringKind::Bend);
        let paths = paths.map(|spring| (spring.ends, spring.rest_length));
        let graph = Graph::new(rest.len(), paths);
        let layout = Layout::new(rest.len() as u32, 1);
        Self(Arc::new(NetworkTree::new(rest, layout, &graph)))
    }

    /// Indices of a node's particles.
    pub(in crate::hierarchy) fn particles_of(&self, node: u32) -> Vec<u32> {
        let level = self.level_of(node);
        let mut nodes = vec![node];
        for _ in level + 1..self.levels().len() {
            nodes = nodes
                .into_iter()
                .flat_map(|node| self.node(node).children().to_vec())
                .collect();
        }
        nodes
            .into_iter()
            .map(|leaf| self.node(leaf).middle)
            .collect()
    }

    /// Checks that each node's children divide its patch, and that each of `particles` particles is in exactly one
    /// leaf.
    ///
    /// # Errors
    /// A message that names the node at fault.
    pub(in crate::hierarchy) fn validate(&self, particles: usize) -> Result<(), String> {
        let last = self.levels().len().saturating_sub(1);
        let mut parent_of = vec![None; self.len()];
        let mut leaf_of = vec![None; particles];
        for (level, nodes) in self.levels().iter().enumerate() {
            for index in nodes.clone() {
                let node = self.node(index);
                if node.is_leaf() != (level == last) {
                    return Err(format!(
                        "node {index} of level {level} of {last} is a leaf too early"
                    ));
                }
                if level > 0 && parent_of[index as usize].is_none() {
                    return Err(format!("node {index} has no parent"));
                }
                for &child in node.children() {
                    let is_below = self.levels()[level + 1].contains(&child);
                    if !is_below || parent_of[child as usize].replace(index).is_some() {
                        return Err(format!(
                            "node {child} is not a child of node {index} alone, one level below"
                        ));
                    }
                }
                if node.is_leaf() {
                    match leaf_of.get_mut(node.middle as usize) {
                        Some(leaf @ None) => *leaf = Some(index),
                        _ => {
                            return Err(format!(
                                "leaf {index} is not the one of particle {}",
                                node.middle
                            ));
                        }
                    }
                }
                if !self.particles_of(index).contains(&node.middle) {
                    return Err(format!("the middle of node {index} is not in it"));
                }
            }
        }
        match leaf_of.iter().position(Option::is_none) {
            None => Ok(()),
            Some(particle) => Err(format!("particle {particle} is in no leaf")),
        }
    }
}

fn grid(columns: u32, rows: u32) -> ClothGrid {
    Cloth::new(columns, rows, 0.5)
        .grid(Vec3::ONE)
        .expect("a valid grid")
}

#[test]
fn every_grid_size_gives_a_valid_tree() {
    let sizes = (2..20).flat_map(|columns| (2..20).map(move |rows| (columns, rows)));
    for (columns, rows) in sizes.chain([
        (33, 2),
        (2, 33),
        (40, 5),
        (65, 7),
        (100, 3),
        (128, 2),
        (130, 2),
    ]) {
        let grid = grid(columns, rows);
        let tree = QuadTree::of_grid(&grid, true);
        assert_eq!(tree.validate(grid.len()), Ok(()), "{columns} × {rows}");
        let depth = columns.max(rows).next_power_of_two().ilog2() as usize;
        assert_eq!(tree.levels().len(), depth + 1, "{columns} × {rows}");
    }
}

#[test]
fn the_papers_cloth_has_256_leaves_on_its_fourth_level() {
    let tree = QuadTree::of_grid(&grid(16, 16), true);
    let counts: Vec<usize> = tree.levels().iter().map(Range::len).collect();
    assert_eq!(counts, [1, 4, 16, 64, 256]);
    for (level, range) in tree.levels().iter().enumerate() {
        assert!(range.clone().all(|node| tree.level_of(node) == level));
    }
}

/// Dijkstra would say the same; on a grid the shortest way is known: diagonals first, then straight on.
#[test]
fn rest_radius_reaches_the_farthest_corner() {
    let tree = QuadTree::of_grid(&grid(16, 16), true);
    // From (7, 7) to (15, 15): eight diagonals of 0.5 √2 m.
    assert!((tree.node(0).rest_radius - 4.0 * 2.0_f32.sqrt()).abs() < 1e-6);
    let tree = QuadTree::of_grid(&grid(16, 16), false);
    assert_eq!(tree.node(0).rest_radius, 8.0);
    let tree = QuadTree::of_grid(&grid(3, 9), true);
    // From (4, 1) to (8, 2): one diagonal and three rows.
    assert!((tree.node(0).rest_radius - 0.5 * 2.0_f32.sqrt() - 1.5).abs() < 1e-6);
    let leaves = tree.levels().last().expect("leaves").clone();
    assert!(
        leaves
            .into_iter()
            .all(|leaf| tree.node(leaf).rest_radius == 0.0)
    );
}

/// The particles and springs of a grid, as a list.
fn network(columns: u32, rows: u32, diagonals: bool) -> (Vec<Vec3>, Vec<Spring>) {
    let grid = grid(columns, rows);
    let material = ClothMaterial {
        shear_compliance: if diagonals { 0.0 } else { f32::INFINITY },
        ..ClothMaterial::COTTON
    };
    let places = grid
        .cells()
        .map(|(row, column)| grid.rest_position(row, column));
    (
        places.collect(),
        Springs::of_grid(&grid, &material).to_vec(),
    )
}

/// The tree of a network, of which each radius is compared with a search over all pairs (Floyd and Warshall).
fn checked(rest: &[Vec3], springs: &[Spring]) -> QuadTree {
    let tree = QuadTree::of_network(rest, springs);
    assert_eq!(tree.validate(rest.len()), Ok(()));
    let count = rest.len();
    let mut distance = vec![vec![f64::INFINITY; count]; count];
    for (index, distances) in distance.iter_mut().enumerate() {
        distances[index] = 0.0;
    }
    for spring in springs
        .iter()
        .filter(|spring| spring.kind != SpringKind::Bend)
    {
        let [a, b] = spring.ends.map(|end| end as usize);
        distance[a][b] = f64::from(spring.rest_length);
        distance[b][a] = distance[a][b];
    }
    for via in 0..count {
        for from in 0..count {
            for to in 0..count {
                distance[from][to] =
                    distance[from][to].min(distance[from][via] + distance[via][to]);
            }
        }
    }
    for index in 0..tree.len() as u32 {
        let node = tree.node(index);
        let distances = tree
            .particles_of(index)
            .into_iter()
            .map(|particle| distance[node.middle as usize][particle as usize]);
        let farthest = distances.fold(0.0, f64::max);
        let radius = f64::from(node.rest_radius);
        assert!(
            radius >= farthest && radius <= farthest * (1.0 + 1e-6),
            "{radius} {farthest}"
        );
    }
    tree
}

/// The same springs as a list: radii are those of the shortest ways.
#[test]
fn a_networks_radii_are_shortest_ways() {
    for (columns, rows, diagonals) in [(2, 2, true), (5, 4, true), (7, 6, false), (9, 3, true)] {
        let (rest, springs) = network(columns, rows, diagonals);
        checked(&rest, &springs);
    }
}

/// With springs missing anywhere: what hangs together is bounded, what does not reaches without end.
#[test]
fn a_torn_networks_radii_are_shortest_ways() {
    let mut state = 5_u32;
    for kept in [9, 6, 4, 2] {
        let (rest, mut springs) = network(9, 8, kept % 3 == 0);
        springs.retain(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % 10 < kept
        });
        checked(&rest, &springs);
    }
}

/// A cloth that is cut in two: a node a level, at most, has to do with both pieces.
#[test]
fn a_cloth_in_two_pieces_has_few_nodes_of_both() {
    let (rest, mut springs) = network(13, 12, true);
    springs.retain(|spring| {
        let [a, b] = spring.ends.map(|end| end % 13 < 5);
        a == b
    });
    let tree = checked(&rest, &springs);
    let is_of_both = |node: &u32| tree.node(*node).rest_radius.is_infinite();
    for level in tree.levels() {
        assert!(level.clone().filter(is_of_both).count() <= 1);
    }
}

/// A network in two pieces has no way from one to the other: its root reaches without end, and holds everything.
#[test]
fn a_network_in_pieces_is_bounded_piece_by_piece() {
    let rest: Vec<Vec3> = (0..7).map(|x| Vec3::X * x as f32).collect();
    let springs: Vec<Spring> = [(0, 1), (1, 2), (3, 4), (4, 5)]
        .map(|(a, b)| Spring {
            kind: SpringKind::Structural,
            ends: [a, b],
            rest_length: 1.0,
            compliance: 0.0,
        })
        .into();
    let tree = QuadTree::of_network(&rest, &springs);
    assert_eq!(tree.validate(7), Ok(()));
    assert_eq!(tree.node(0).rest_radius, f32::INFINITY);
    let leaves = tree.levels().last().expect("leaves").clone();
    assert!(
        leaves
            .into_iter()
            .all(|leaf| tree.node(leaf).rest_radius == 0.0)
    );
}

#[test]
fn validate_finds_what_is_broken() {
    let grid = grid(5, 3);
    let break_it = |mend: fn(&mut GridTree)| {
        let mut tree = GridTree::new(&grid, true);
        mend(&mut tree);
        QuadTree(Arc::new(tree)).validate(15)
    };
    assert_eq!(break_it(|_| {}), Ok(()));
    assert!(break_it(|tree| tree.levels[0].columns[0].children.end -= 1).is_err());
    assert!(
        break_it(|tree| tree.levels.last_mut().expect("leaves").columns[4].middle = 0).is_err()
    );
    assert!(break_it(|tree| tree.levels[1].rows[0].children = 1..2).is_err());
    assert!(QuadTree::of_grid(&grid, true).validate(16).is_err());
}

/// As many particles in rows and columns lie elsewhere than those of a network, which lie in one row.
#[test]
fn a_network_is_not_of_particles_in_a_grid() {
    let surface = Cloth::new(12, 3, 0.1)
        .surface(Vec3::ONE)
        .expect("a valid grid");
    let in_grid = ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("particles");
    let rest: Vec<Vec3> = in_grid.positions().collect();
    let in_row = ClothParticles::new(&rest, &vec![1.0; rest.len()]).expect("particles");
    let tree = QuadTree::of_network(&rest, &[]);
    assert!(tree.matches(&in_row) && !tree.matches(&in_grid));
}

/// Pieces of a torn cloth may be lost, each in its own direction.
#[test]
fn a_sphere_around_two_has_both() {
    let corner = |direction: f32| Vec3::splat(direction);
    let places = [
        0.0,
        1.0e-3,
        1.0,
        -7.3,
        1.0e6,
        -1.0e18,
        3.0e30,
        f32::MAX,
        f32::MIN,
    ];
    let radii = [0.0, 1.0e-3, 0.7, 1.0e4, 1.0e30];
    for (from, to) in places.iter().flat_map(|a| places.map(|b| (*a, b))) {
        for (one, other) in radii.iter().flat_map(|a| radii.map(|b| (*a, b))) {
            let around = merged(&BoundingSphere::new(corner(from), one), corner(to), other);
            for (place, radius) in [(from, one), (to, other)] {
                let apart = around.center.as_dvec3().distance(corner(place).as_dvec3());
                let reach = f64::from(around.radius());
                assert!(
                    apart + f64::from(radius) <= reach * (1.0 + 1.0e-7),
                    "{from} ± {one}, {to} ± {other}: {around:?}"
                );
            }
            let needed = (corner(from).as_dvec3().distance(corner(to).as_dvec3())
                + f64::from(one + other))
                / 2.0;
            let needed = needed.max(f64::from(one.max(other)));
            let largest = f64::from(from.abs().max(to.abs()));
            let is_finite = needed < f64::from(f32::MAX);
            let most = needed * 1.00001 + largest * 1.0e-6;
            assert!(f64::from(around.radius()) <= most || !is_finite);
        }
    }
    for lost in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let known = BoundingSphere::new(Vec3::ONE, 1.0);
        let _ = merged(&known, corner(lost), 1.0);
        let _ = merged(&BoundingSphere::new(corner(lost), 1.0), Vec3::ONE, f32::MAX);
    }
}
