//! Chains of grids, of irregular meshes, of what is closed, and of what is too small.

use std::collections::HashSet;

use super::*;
use crate::cloth::{
    spring::SpringKind,
    surface::{Surface, triangles::TriangleMesh},
};

/// A grid of triangles with the same diagonal everywhere, put somewhere by `place`. A column that is as many as there are is the
/// first one again.
fn grid(columns: u32, rows: u32, wraps: bool, place: impl Fn(u32, u32) -> Vec3) -> Surface {
    let mut mesh = TriangleMesh::default();
    for row in 0..rows {
        mesh.positions
            .extend((0..columns).map(|column| place(row, column)));
    }
    for row in 0..rows - 1 {
        for column in 0..columns - u32::from(!wraps) {
            let at = |row: u32, column: u32| row * columns + column % columns;
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            mesh.triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a surface")
}

/// Where particles are that are up to a part of a spacing out of place.
fn jittered(part: f32) -> impl Fn(u32, u32) -> Vec3 {
    move |row, column| {
        let at = (row * 1000 + column) as f32;
        let off = Vec3::new((at * 12.9).sin(), (at * 78.2).cos(), 0.0);
        Vec3::new(column as f32, -(row as f32), 0.0) + off * part
    }
}

fn edges(surface: &Surface) -> Vec<[u32; 2]> {
    let links = surface.links().iter();
    let links = links.filter(|link| link.kind == SpringKind::Structural);
    links.map(|link| link.ends).collect()
}

/// Fails unless each chain is a path of two or more edges that meets no particle twice, no edge is on two, and no two chains
/// of one colour share a particle. Returns how many edges are on chains.
fn check(surface: &Surface) -> usize {
    let edges = edges(surface);
    let mut seen = HashSet::new();
    for colour in &surface.chains().colours {
        let mut particles = HashSet::new();
        assert!(colour.is_sorted_by_key(|chain| std::cmp::Reverse(chain.edges.len())));
        for chain in colour {
            assert!(chain.edges.len() > 1);
            let mut at = chain.first;
            assert!(particles.insert(at), "{at} twice");
            for &edge in &chain.edges {
                assert!(seen.insert(edge), "{edge} twice");
                let [a, b] = edges[edge as usize];
                assert!(at == a || at == b, "{edge} does not go on from {at}");
                at = if at == a { b } else { a };
                assert!(particles.insert(at), "{at} twice");
            }
        }
    }
    seen.len()
}

/// Twelve columns and nine rows: chains are the rows, the columns and the diagonals, each family a colour of its own; alone are
/// only the edges that cut off two corners.
#[test]
fn chains_of_a_grid_are_its_rows_columns_and_diagonals() {
    let surface = grid(12, 9, false, jittered(0.0));
    let alone = edges(&surface).len() - check(&surface);
    assert_eq!(alone, 2);
    let colours = &surface.chains().colours;
    let lengths: Vec<Vec<usize>> = colours
        .iter()
        .map(|colour| colour.iter().map(|chain| chain.edges.len()).collect())
        .collect();
    let mut diagonals = vec![8; 4];
    diagonals.extend((2..8).rev().flat_map(|length| [length; 2]));
    assert_eq!(lengths[0], [11; 9]);
    // Columns and the longest diagonals are as long as each other.
    let mut others = lengths[1..].concat();
    others.sort_unstable_by(|a, b| b.cmp(a));
    let mut expected = [vec![8; 12], diagonals].concat();
    expected.sort_unstable_by(|a, b| b.cmp(a));
    assert_eq!(others, expected);
    let rest = surface.rest_positions();
    for chain in surface.chains().iter() {
        let edges = edges(&surface);
        let span = |edge: &u32| {
            let [a, b] = edges[*edge as usize].map(|end| rest[end as usize]);
            (b - a)
                * if a.y + 0.1 * a.x > b.y + 0.1 * b.x {
                    1.0
                } else {
                    -1.0
                }
        };
        let first = span(&chain.edges[0]);
        assert!(
            chain
                .edges
                .iter()
                .all(|edge| span(edge).distance(first) < 1.0e-5)
        );
    }
}

/// Some edges are alone, on an irregular mesh, but few; the same each time.
#[test]
fn nearly_all_edges_of_an_irregular_mesh_are_on_chains() {
    for (part, part_on_chains) in [(0.05, 98), (0.1, 95), (0.2, 88), (0.3, 75)] {
        let surface = grid(23, 17, false, jittered(part));
        let (all, on_chains) = (edges(&surface).len(), check(&surface));
        assert!(
            on_chains * 100 > all * part_on_chains,
            "{on_chains} of {all} at {part}"
        );
        let again = grid(23, 17, false, jittered(part));
        assert_eq!(surface.chains(), again.chains());
    }
}

/// Around a cylinder of ten columns, which are ten edges from one to the next of which nine are one chain; down it, and
/// helically, straight on the surface though not in space.
#[test]
fn what_goes_around_a_cylinder_is_cut_open() {
    let around = |row: u32, column: u32| {
        let (s, c) = (column as f32 * std::f32::consts::TAU / 10.0).sin_cos();
        Vec3::new(c, -0.6 * row as f32, s)
    };
    let surface = grid(10, 6, true, around);
    let on_chains = check(&surface);
    let rings = surface.chains().iter();
    let rings = rings.filter(|chain| chain.edges.len() == 9).count();
    assert_eq!(rings, 6);
    // Of each ring one edge is alone; five down each column, and along each helix.
    assert_eq!(on_chains, 6 * 9 + 10 * 5 + 10 * 5);
}

#[test]
fn a_single_triangle_has_none() {
    let mesh = TriangleMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        ..TriangleMesh::default()
    };
    let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
    assert_eq!(surface.chains().iter().count(), 0);
    assert_eq!(Surface::default().chains().iter().count(), 0);
}

/// Edges of a fan of very many meet in one particle, more chains than there are colours: what is over is on none.
#[test]
fn a_hub_has_no_more_chains_than_colours() {
    let spokes = 300_u32;
    let mut positions = vec![Vec3::ZERO];
    positions.extend((0..spokes).map(|at| {
        let (s, c) = (at as f32 * std::f32::consts::TAU / spokes as f32).sin_cos();
        Vec3::new(c, s, 0.0)
    }));
    let mesh = TriangleMesh {
        positions,
        triangles: (0..spokes)
            .map(|at| [0, 1 + at, 1 + (at + 1) % spokes])
            .collect(),
        ..TriangleMesh::default()
    };
    let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
    check(&surface);
    assert!(surface.chains().colours.len() <= MAX_COLOURS as usize);
}
