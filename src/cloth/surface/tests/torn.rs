//! Torn surfaces against brute force, and the springs that are left.

use std::sync::Arc;

use bevy::{math::Vec3, platform::collections::HashMap};

use super::*;
use crate::{
    cloth::{Cloth, ClothMaterial, SpringKind, Springs},
    meshes::irregular,
};

struct Random(u32);

impl Random {
    /// Below this number (Knuth's constants).
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as usize % end
    }
}

fn grid() -> Arc<Surface> {
    Arc::new(Cloth::new(8, 6, 0.1).surface(Vec3::ONE).expect("a grid"))
}

fn mesh() -> Arc<Surface> {
    let mesh = irregular(0.7, 0.5, 0.1, 0.3);
    Arc::new(Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface"))
}

/// All edges of the faces, the smaller end first.
fn edges(surface: &Surface) -> Vec<[u32; 2]> {
    let sides = |[a, b, c]: &[u32; 3]| [[*a, *b], [*b, *c], [*c, *a]];
    let mut edges: Vec<[u32; 2]> = surface.triangles().iter().flat_map(sides).collect();
    edges.iter_mut().for_each(|edge| edge.sort_unstable());
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Some of the edges, in any order.
fn some(edges: &[[u32; 2]], count: usize, random: &mut Random) -> Vec<[u32; 2]> {
    let mut left = edges.to_vec();
    let count = count.min(left.len());
    (0..count)
        .map(|_| left.swap_remove(random.below(left.len())))
        .collect()
}

/// The corners of faces that hang together at edges that are not torn, by joining them one by one.
fn joined(whole: &Surface, torn: &[[u32; 2]]) -> Vec<[usize; 3]> {
    let faces = whole.triangles();
    let mut label: Vec<[usize; 3]> = (0..faces.len())
        .map(|face| [3 * face, 3 * face + 1, 3 * face + 2])
        .collect();
    let mut sides: HashMap<[u32; 2], Vec<usize>> = HashMap::default();
    for (index, [a, b, c]) in faces.iter().enumerate() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            sides
                .entry([*from.min(to), *from.max(to)])
                .or_default()
                .push(index);
        }
    }
    let at = |face: usize, particle: u32| {
        faces[face]
            .iter()
            .position(|corner| *corner == particle)
            .expect("a corner")
    };
    let mut changes = true;
    while std::mem::take(&mut changes) {
        for (edge, of) in sides.iter().filter(|(edge, _)| !torn.contains(*edge)) {
            for (one, two) in of.iter().zip(&of[1..]) {
                for end in edge {
                    let (i, j) = (at(*one, *end), at(*two, *end));
                    let least = label[*one][i].min(label[*two][j]);
                    changes |= label[*one][i] != label[*two][j];
                    (label[*one][i], label[*two][j]) = (least, least);
                }
            }
        }
    }
    label
}

/// The particles of each face, in the order of the whole surface's faces.
fn corners(surface: &Surface) -> &[[u32; 3]] {
    &surface.torn.as_ref().expect("it is torn").corners
}

/// The particles of a torn surface are the corners of faces that hang together: none more, none fewer.
#[test]
fn particles_are_split_as_by_brute_force() {
    let mut random = Random(1);
    for whole in [grid(), mesh()] {
        let edges = edges(&whole);
        for count in [1, 2, 5, 20, 60, edges.len()] {
            let torn = some(&edges, count, &mut random);
            let surface = whole.torn(&torn).expect("edges");
            let expected = joined(&whole, &torn);
            let mut names: HashMap<u32, usize> = HashMap::default();
            for (own, label) in corners(&surface).iter().zip(&expected) {
                for (own, label) in own.iter().zip(label) {
                    assert_eq!(*names.entry(*own).or_insert(*label), *label, "{count}");
                }
            }
            let mut labels: Vec<usize> = names.values().copied().collect();
            labels.sort_unstable();
            labels.dedup();
            assert_eq!(
                labels.len(),
                surface.len(),
                "{count}: two particles of one part"
            );
            let all: Vec<usize> = expected.into_iter().flatten().collect();
            assert!(all.iter().all(|label| labels.binary_search(label).is_ok()));
        }
        // Each face for itself.
        let all = whole.torn(&edges).expect("edges");
        assert_eq!(all.len(), 3 * whole.triangles().len());
        assert_eq!(all.pieces(), whole.triangles().len());
    }
}

/// A tear more leaves the indices of the particles as they were, and the area of each part adds up to that of the whole, to
/// some roundings.
#[test]
fn indices_stay_and_areas_add_up() {
    let mut random = Random(7);
    for whole in [grid(), mesh()] {
        let torn = some(&edges(&whole), 40, &mut random);
        let mut before = whole.clone();
        for count in 1..=torn.len() {
            let surface = Arc::new(whole.torn(&torn[..count]).expect("edges"));
            let again = before.torn(&torn[..count]).expect("edges");
            assert_eq!(
                corners(&surface),
                corners(&again),
                "from the whole or from the torn one"
            );
            assert!(surface.len() >= before.len());
            let parents = surface.parents_in(&before).expect("of one whole");
            assert!((0..before.len()).all(|index| parents[index] == index as u32));
            let mut sums = vec![0.0; whole.len()];
            for particle in 0..surface.len() {
                assert!(surface.area_of(particle) > 0.0);
                assert_eq!(
                    surface.origin_of(particle as u32),
                    before.origin_of(parents[particle])
                );
                sums[surface.origin_of(particle as u32) as usize] += surface.area_of(particle);
            }
            for (index, sum) in sums.iter().enumerate() {
                let error = (sum - whole.area_of(index)).abs();
                assert!(error <= 1.0e-6 * whole.area_of(index), "{index}: {error}");
            }
            before = surface;
        }
    }
}

/// Its springs, by their ends in the whole surface, with their rest lengths and compliances.
fn springs(surface: &Surface, material: &ClothMaterial) -> Vec<([u32; 2], SpringKind, f32, f32)> {
    let mut springs = Vec::new();
    Springs::of_surface(surface, material).for_each(|_, spring| {
        let mut ends = spring.ends.map(|end| surface.origin_of(end));
        ends.sort_unstable();
        springs.push((ends, spring.kind, spring.rest_length, spring.compliance));
    });
    springs.sort_by(|a, b| a.0.cmp(&b.0).then(a.3.total_cmp(&b.3)));
    springs
}

/// One torn edge in the middle of a cloth opens nothing, so all springs stay as they were. Those of a grid are a mesh's now,
/// and pull as hard.
#[test]
fn springs_are_those_of_the_whole_where_nothing_opens() {
    let woven = ClothMaterial {
        stretch_compliance: 2.0e-3,
        ..ClothMaterial::DENIM
    };
    for (whole, edge) in [(grid(), [19, 20]), (grid(), [19, 27]), (mesh(), [0, 0])] {
        let edge = match edge {
            [0, 0] => {
                let mut edges = edges(&whole).into_iter();
                let is_inside =
                    |[a, b]: &[u32; 2]| ![a, b].iter().any(|end| whole.is_border[**end as usize]);
                edges.find(is_inside).expect("an edge inside")
            }
            edge => edge,
        };
        let torn = whole.torn(&[edge]).expect("an edge");
        assert_eq!(torn.len(), whole.len());
        for material in [ClothMaterial::COTTON, ClothMaterial::default(), woven] {
            let (expected, found) = (springs(&whole, &material), springs(&torn, &material));
            assert_eq!(expected.len(), found.len());
            for (one, two) in expected.iter().zip(&found) {
                assert_eq!((one.0, one.1), (two.0, two.1));
                let differ = |a: f32, b: f32| (a - b).abs() > 2.0e-6 * a.abs();
                assert!(
                    !differ(one.2, two.2) && !differ(one.3, two.3),
                    "{one:?} {two:?}"
                );
            }
        }
    }
}

/// A spring along a tear becomes two that together pull as hard, and every other one stays, but those across the tear.
#[test]
fn torn_springs_pull_as_hard_together() {
    let mut random = Random(3);
    let material = ClothMaterial {
        // Softer stretch leaves a mesh springs across its edges.
        shear_compliance: 2.0e-5,
        ..ClothMaterial::COTTON
    };
    for whole in [grid(), mesh()] {
        let torn = some(&edges(&whole), 50, &mut random);
        let surface = whole.torn(&torn).expect("edges");
        let stiffness = |surface: &Surface, kind: SpringKind| {
            let mut sums: HashMap<[u32; 2], f32> = HashMap::default();
            for (ends, of, _, compliance) in springs(surface, &material) {
                if of == kind {
                    *sums.entry(ends).or_default() += 1.0 / compliance;
                }
            }
            sums
        };
        let [before, after] = [&*whole, &surface].map(|of| stiffness(of, SpringKind::Structural));
        assert_eq!(before.len(), after.len());
        for (ends, sum) in before {
            assert!((after[&ends] / sum - 1.0).abs() < 1.0e-5, "{ends:?}");
        }
        let [before, after] = [&*whole, &surface].map(|of| {
            springs(of, &material)
                .iter()
                .filter(|spring| spring.1 != SpringKind::Structural)
                .count()
        });
        assert!(after <= before + torn.len() && after > 0);
    }
}

/// A tetrahedron with a fin at the edge of its first and last particle. Torn there, its own two faces still hang together around both
/// ends. The fin, which is between them in the order of faces, does not.
fn tetrahedron_with_fin() -> Arc<Surface> {
    let places = [[0, 0, 0], [0, 1, 0], [0, -1, -1], [0, 0, 1], [1, 0, 0]];
    let positions = places.map(|place| Vec3::from_array(place.map(|along| along as f32)));
    let mesh = TriangleMesh {
        positions: positions.to_vec(),
        triangles: vec![[0, 4, 1], [0, 4, 2], [4, 0, 3], [0, 1, 3], [4, 3, 1]],
        ..Default::default()
    };
    Arc::new(Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface"))
}

/// The sides of a torn surface are those of its faces, and those at one edge lie beside each other; also where three faces meet.
#[test]
fn torn_sides_are_those_of_the_faces() {
    let mut random = Random(11);
    for whole in [grid(), mesh(), tetrahedron_with_fin()] {
        let all = edges(&whole);
        let tears = [0, 1, 2, 5, 20].map(|count| some(&all, count, &mut random));
        for tear in tears.into_iter().chain(all.iter().map(|edge| vec![*edge])) {
            let surface = whole.torn(&tear).expect("edges");
            let torn = surface.torn.as_ref().expect("a torn surface");
            let mut sides = torn.sides();
            let runs = sides.chunk_by(|a, b| a.ends == b.ends).count();
            sides.sort_unstable();
            assert_eq!(sides, springs::sides_of(&torn.corners));
            let mut ends: Vec<[u32; 2]> = sides.iter().map(|side| side.ends).collect();
            ends.dedup();
            assert_eq!(runs, ends.len());
        }
    }
}

#[test]
fn an_edge_that_is_none_is_named() {
    for edge in [[0, 17], [3, 3], [0, 4_000], [9, 8]] {
        assert_eq!(
            grid().torn(&[[0, 1], edge]).err(),
            Some(TearError::NoSuchEdge { edge })
        );
    }
}

/// From any tears to any other, also to fewer: each particle comes from one that was at the same place, and is no farther from it than a cut
/// is wide.
#[test]
fn torn_surfaces_follow_each_other() {
    let mut random = Random(5);
    for whole in [grid(), mesh()] {
        let edges = edges(&whole);
        let mut before = whole.clone();
        for _ in 0..60 {
            let count = random.below(edges.len());
            let torn = whole.torn(&some(&edges, count, &mut random));
            let after = Arc::new(torn.expect("edges"));
            let parents = after.parents_in(&before).expect("one whole surface");
            let places: Vec<Vec3> = (0..after.len() as u32)
                .map(|particle| whole.rest_positions()[after.origin_of(particle) as usize])
                .collect();
            let parted = after.parted(&places, |particle| parents[particle as usize]);
            for (particle, parent) in parents.iter().enumerate() {
                assert_eq!(after.origin_of(particle as u32), before.origin_of(*parent));
                let moved = parted[particle].distance(places[particle]);
                // A fiftieth of the way to the middle of faces, whose sides are shorter than two spacings.
                assert!(moved < 0.02 * 0.2, "{moved}");
            }
            before = after;
        }
    }
}
