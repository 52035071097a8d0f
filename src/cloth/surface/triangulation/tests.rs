//! Edges that are turned, and edges that stay.

use std::sync::Arc;

use bevy::math::{DVec3, Vec3};

use super::{
    Triangulation,
    turning::{ALIKE, Turning},
};
use crate::cloth::arrays::sorted;
use crate::cloth::surface::{Surface, TriangleMesh, springs::sides_of};

const SIDE: u32 = 12;

/// A square of `SIDE` cells whose inner vertices are moved by up to `jitter` sides of one in x and in y. `is_other` says which
/// diagonal a cell has.
fn square(
    jitter: f64,
    seed: u32,
    is_other: impl Fn(u32, u32) -> bool,
) -> (Vec<[u32; 3]>, Vec<DVec3>) {
    let mut state = seed;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    };
    let (mut faces, mut places) = (Vec::new(), Vec::new());
    for row in 0..=SIDE {
        for column in 0..=SIDE {
            let is_inner = (1..SIDE).contains(&row) && (1..SIDE).contains(&column);
            let moved = if is_inner { jitter } else { 0.0 };
            places.push(
                DVec3::new(f64::from(column), f64::from(row), 0.0)
                    + moved * DVec3::new(noise(), noise(), 0.0),
            );
            if row < SIDE && column < SIDE {
                let a = row * (SIDE + 1) + column;
                let (b, c, d) = (a + 1, a + SIDE + 1, a + SIDE + 2);
                faces.extend(if is_other(column, row) {
                    [[a, b, d], [a, d, c]]
                } else {
                    [[a, b, c], [b, d, c]]
                });
            }
        }
    }
    (faces, places)
}

fn alternating(column: u32, row: u32) -> bool {
    (column + row).is_multiple_of(2)
}

fn random(seed: u32) -> impl Fn(u32, u32) -> bool {
    move |column, row| {
        let number = (column * 7 + row * 13 + seed * 5).wrapping_mul(2_654_435_761);
        number >> 16 & 1 == 0
    }
}

/// Number of cells with the diagonal from their first to their last vertex, and with the other one.
fn directions(faces: &[[u32; 3]]) -> [usize; 2] {
    let edges = faces.iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let lengths: Vec<u32> = edges.map(|[a, b]| a.abs_diff(*b)).collect();
    // Each is an edge of two faces.
    [SIDE + 2, SIDE].map(|length| lengths.iter().filter(|of| **of == length).count() / 2)
}

fn plain(faces: &[[u32; 3]]) -> Triangulation {
    Triangulation::of(faces, &sides_of(faces))
}

fn turned(faces: &[[u32; 3]], places: &[DVec3]) -> Triangulation {
    super::turned(faces, places, &[])
}

/// Squares, squares that are not quite square, and long cells: whatever their diagonals were, they become parallel, and parallel ones stay.
#[test]
fn diagonals_of_squares_become_parallel() {
    let all = (SIDE * SIDE) as usize;
    for (jitter, wide) in [(0.0, 1.0), (0.025, 1.0), (0.0, 8.0), (0.0, 0.125)] {
        let (regular, mut places) = square(jitter, 1, |_, _| true);
        places.iter_mut().for_each(|place| place.x *= wide);
        assert_eq!(turned(&regular, &places).faces(), regular);
        let made: [Box<dyn Fn(u32, u32) -> bool>; 4] = [
            Box::new(alternating),
            Box::new(|_, row| row % 2 == 0),
            Box::new(random(1)),
            Box::new(random(2)),
        ];
        for is_other in made {
            let (faces, mut places) = square(jitter, 1, is_other);
            places.iter_mut().for_each(|place| place.x *= wide);
            assert!(directions(&faces).iter().all(|count| *count > all / 4));
            let mut found = directions(turned(&faces, &places).faces());
            found.sort_unstable();
            assert_eq!(found, [0, all]);
        }
    }
}

/// The same vertices, as many faces, none turned over, the same area; and what lies beside each is what a new look at the faces
/// finds. Before diagonals are aligned, no edge is worse than the other diagonal. Moved by less than a quarter, no face begins turned
/// over.
#[test]
fn irregular_faces_become_about_delaunay() {
    for seed in 0..40 {
        let (faces, places) = square(0.24, seed, random(seed));
        let found = turned(&faces, &places);
        let area = |[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|corner| places[*corner as usize]);
            (b - a).cross(c - a).z / 2.0
        };
        let areas: Vec<f64> = found.faces().iter().map(area).collect();
        let all = f64::from(SIDE * SIDE);
        assert!(areas.iter().all(|area| *area > 0.0));
        assert_eq!(areas.len(), faces.len());
        // A sum of 288 numbers.
        assert!((areas.iter().sum::<f64>() - all).abs() < 1.0e-12 * all);
        let again = plain(found.faces());
        assert!((0..faces.len()).all(|face| found.beside(face) == again.beside(face)));
        let mut turning = Turning::new(plain(&faces), &places, &[]);
        turning.turn_worse_ones();
        assert!(!turning.of.turns.is_empty());
        for (face, edge) in (0..faces.len()).flat_map(|face| [0, 1, 2].map(|edge| (face, edge))) {
            let sums = turning.cotangents(face, edge);
            assert!(
                sums.is_none_or(|[sum, _]| sum >= -ALIKE),
                "{seed}: {sums:?}"
            );
        }
    }
}

/// A roof keeps its ridge, and a seam of two grains its diagonals. A pillow of four faces keeps both of its diagonals: turned, either
/// would be the other.
#[test]
fn what_is_folded_woven_or_closed_stays() {
    // Two fabrics meet along the diagonals of the cells from one corner to another, and all other cells have the other diagonal.
    let is_seam = |column: u32, row: u32| column + row == SIDE - 1;
    let (faces, places) = square(0.0, 1, |column, row| !is_seam(column, row));
    let middle = |face: &[u32; 3]| {
        face.iter()
            .map(|at| at % (SIDE + 1) + at / (SIDE + 1))
            .sum::<u32>()
    };
    let is_beyond = |face: &[u32; 3]| middle(face) > 3 * SIDE;
    let grain: Vec<Vec3> = faces
        .iter()
        .map(|face| if is_beyond(face) { Vec3::X } else { Vec3::Y })
        .collect();
    let seam = |grain: &[Vec3]| directions(super::turned(&faces, &places, grain).faces())[1];
    assert_eq!([seam(&grain), seam(&[])], [SIDE as usize, 0]);
    let (faces, mut places) = square(0.0, 1, alternating);
    for place in &mut places {
        place.z = (place.x - place.y).abs();
    }
    let found = turned(&faces, &places);
    let is_ridge = |[a, b]: [u32; 2]| a % (SIDE + 2) == 0 && b % (SIDE + 2) == 0;
    let ridges = |of: &Triangulation| {
        let each = (0..of.faces.len()).flat_map(|face| [0, 1, 2].map(|edge| (face, edge)));
        each.filter(|(face, edge)| is_ridge(of.edge(*face, *edge)))
            .count()
    };
    assert_eq!(ridges(&found), ridges(&plain(&faces)));
    let corners = [
        DVec3::ZERO,
        3.0 * DVec3::X,
        DVec3::new(1.5, 0.5, 0.0),
        DVec3::new(1.5, -0.5, 0.0),
    ];
    let pillow = [[0, 1, 2], [1, 0, 3], [0, 2, 3], [1, 3, 2]];
    assert!(
        Turning::new(plain(&pillow), &corners, &[])
            .cotangents(0, 0)
            .is_some_and(|[sum, _]| sum < -ALIKE),
        "the front's other diagonal would be better"
    );
    assert_eq!(turned(&pillow, &corners).faces(), pillow);
}

/// A tear turns nothing but diagonals that it cuts: all others are where they were, in the order of the whole surface's faces.
#[test]
fn a_tear_turns_nothing_far_away() {
    let (triangles, places) = square(0.0, 1, alternating);
    let mesh = TriangleMesh {
        positions: places.iter().map(|place| place.as_vec3()).collect(),
        triangles,
        ..Default::default()
    };
    let whole = Arc::new(Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface"));
    let particle = |vertex: u32| {
        let found = whole.particle_of_vertex(vertex as usize);
        found.expect("each has one") as u32
    };
    let along = |first: u32, step: u32, count: u32| -> Vec<[u32; 2]> {
        let ends = |at: u32| [first + at * step, first + (at + 1) * step];
        (0..count)
            .map(|at| sorted(ends(at).map(particle)))
            .collect()
    };
    let row = SIDE + 1;
    // From border to border, and slits inside.
    let slits = [
        along(6 * row, 1, SIDE),
        along(6, row, SIDE),
        along(6 * row + 4, 1, 4),
        along(3 * row + 7, row, 5),
    ];
    let turn = whole.bending_faces().turns[0];
    let diagonal = sorted([turn.quad[0], turn.quad[1]]);
    for mut edges in slits {
        edges.push(diagonal);
        let torn = whole.torn(&edges).expect("edges");
        assert!(torn.len() > whole.len());
        let before = whole.bending_faces().faces();
        let after = torn.bending_faces().faces();
        let origin = |face: &[u32; 3]| face.map(|at| torn.origin_of(at));
        let pairs = before.iter().zip(after);
        let changed = pairs
            .filter(|(before, after)| **before != origin(after))
            .count();
        assert_eq!(changed, 2, "those beside the torn diagonal");
    }
}
