//! Whether a box shows through a cloth: how many triangles its edges pass through, by brute force.

use bevy::prelude::*;

/// Pairs of an edge of a box and a triangle of a cloth that it passes through, all in the box's frame.
pub fn edges_through(half_size: Vec3, places: &[Vec3], triangles: &[[u32; 3]]) -> usize {
    let edges = edges(half_size);
    let corners = |triangle: &[u32; 3]| triangle.map(|index| places[index as usize]);
    let passes = |triangle: [Vec3; 3]| {
        let [low, high] = [Vec3::min, Vec3::max].map(|of| triangle.into_iter().reduce(of));
        let (Some(low), Some(high)) = (low, high) else {
            return 0;
        };
        if low.cmpgt(half_size).any() || high.cmplt(-half_size).any() {
            return 0;
        }
        let through = edges.iter().filter(|edge| is_through(**edge, triangle));
        through.count()
    };
    triangles.iter().map(corners).map(passes).sum()
}

/// A box's twelve.
fn edges(half_size: Vec3) -> Vec<[Vec3; 2]> {
    let mut edges = Vec::new();
    for axis in 0..3 {
        for (one, other) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let mut start = half_size;
            start[(axis + 1) % 3] *= one;
            start[(axis + 2) % 3] *= other;
            let mut end = start;
            end[axis] = -end[axis];
            edges.push([start, end]);
        }
    }
    edges
}

/// Whether the way from one point to another passes through a triangle (Möller and Trumbore 1997).
fn is_through([start, end]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let (way, first, second) = (end - start, b - a, c - a);
    let across = way.cross(second);
    let volume = first.dot(across);
    if volume.abs() < 1.0e-12 {
        return false;
    }
    let from = start - a;
    let u = from.dot(across) / volume;
    let up = from.cross(first);
    let v = way.dot(up) / volume;
    let along = second.dot(up) / volume;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&along)
}
