//! Distances in lanes are those of nearest points.

use bevy::math::{Vec3, Vec3A};

use super::thrown::Draw;
use crate::contact::layers::{
    bounds::Bounds,
    lanes::{Groups, Hits, Points, near_edges, near_faces},
    pair::{Nearest, TWO_EDGES, VERTEX_AND_FACE},
};

/// The points of eight features.
fn points<const N: usize>(features: &[[Vec3A; N]; 8]) -> [Points; N] {
    std::array::from_fn(|point| {
        std::array::from_fn(|axis| std::array::from_fn(|l| features[l][point][axis]))
    })
}

/// The first `count` features of a group.
fn group<const N: usize>(points: &[Points; N], count: usize) -> Groups<'_, N> {
    let bounds = Bounds {
        min: Vec3A::NEG_INFINITY,
        max: Vec3A::INFINITY,
    };
    Groups::of(points, count, bounds)
}

/// A feature of some size around the middle: sometimes flat, parallel to x, a line or a point.
fn feature<const N: usize>(draw: &mut Draw) -> [Vec3A; N] {
    let (size, kind) = (10.0_f32.powf(draw.next()), (8.0 * draw.next()) as i32);
    let middle = Vec3A::from(draw.vector());
    std::array::from_fn(|corner| {
        let along = Vec3::X * corner as f32;
        let off = match kind {
            -1 | 1 => along,
            2 => Vec3::ZERO,
            3 => along + 1.0e-4 * draw.vector(),
            4 => draw.vector() * Vec3::new(1.0, 0.0, 1.0),
            _ => draw.vector(),
        };
        middle + Vec3A::from(off * size)
    })
}

/// Nearer than a thousandth of the distance and of the longest edge, which comparisons allow.
#[test]
fn they_are_those_of_nearest_points() {
    let mut draw = Draw(7);
    for _ in 0..4_000 {
        let [vertex] = feature::<1>(&mut draw);
        let faces: [[Vec3A; 3]; 8] = std::array::from_fn(|_| feature(&mut draw));
        let edge = feature::<2>(&mut draw);
        let edges: [[Vec3A; 2]; 8] = std::array::from_fn(|_| feature(&mut draw));
        let (mut squares, mut edge_squares) = (Hits::default(), Hits::default());
        near_faces(
            &group(&points(&[[vertex]; 8]), 1),
            &group(&points(&faces), 8),
            f32::INFINITY,
            &mut squares,
        );
        near_edges(
            &group(&points(&[edge; 8]), 1),
            &group(&points(&edges), 8),
            f32::INFINITY,
            &mut edge_squares,
        );
        for l in 0..8 {
            let [a, b, c] = faces[l];
            let truth = Nearest::of(VERTEX_AND_FACE, [vertex, a, b, c]).distance;
            let longest = (a - b).length().max((b - c).length()).max((c - a).length());
            let off = (squares.of[l].square.sqrt() - truth).abs();
            assert!(
                off <= 1.0e-3 * (truth + longest),
                "{vertex} {:?}: {truth}, {off}",
                faces[l]
            );
            let [r, s] = edges[l];
            let truth = Nearest::of(TWO_EDGES, [edge[0], edge[1], r, s]).distance;
            let longest = (edge[0] - edge[1]).length().max((r - s).length());
            let off = (edge_squares.of[l].square.sqrt() - truth).abs();
            assert!(
                off <= 1.0e-3 * (truth + longest),
                "{edge:?} {:?}: {truth}, {off}",
                edges[l]
            );
        }
    }
}
