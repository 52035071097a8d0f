//! The edges of a box.

use bevy::math::Vec3;

use super::geometry::SharpEdge;

/// Number of edges of a box.
pub(crate) const EDGES: u32 = 12;

/// One of the edges of a box around the origin.
#[inline]
pub(crate) fn edge(half: Vec3, index: u32) -> SharpEdge {
    // The axis that it is parallel to, and its side of the other two axes.
    let (axis, side) = ((index / 4) as usize, index % 4);
    let (second, third) = ((axis + 1) % 3, (axis + 2) % 3);
    let sign = |bit: u32| if side & bit == 0 { -1.0_f32 } else { 1.0 };
    let mut outward = Vec3::ZERO;
    (outward[second], outward[third]) = (sign(1), sign(2));
    let mut along = Vec3::ZERO;
    along[axis] = 1.0;
    SharpEdge {
        ends: [(outward - along) * half, (outward + along) * half],
        outward: outward * std::f32::consts::FRAC_1_SQRT_2,
        radius: 0.0,
        round: 0.0,
        part: 1.0,
    }
}

/// Distance of a point from the nearest edge of a box around the origin (m).
pub(crate) fn edge_distance(half: Vec3, point: Vec3) -> f32 {
    // Distances from the planes of its faces, and beyond them.
    let beside = point.abs() - half;
    let squares = beside * beside;
    let beyond = beside.max(Vec3::ZERO);
    let along = beyond * beyond;
    let x = along.x + squares.y + squares.z;
    let y = along.y + squares.z + squares.x;
    let z = along.z + squares.x + squares.y;
    x.min(y).min(z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::tests::Random;

    /// The formula is the least of the distances from the twelve edges.
    #[test]
    fn the_nearest_edge_is_the_least_of_twelve() {
        let mut random = Random(7);
        for _ in 0..2_000 {
            let half = random.within(1.0).abs() + 0.01;
            let point = random.within(3.0);
            let each = (0..EDGES).map(|index| edge(half, index).distance(point));
            let least = each.fold(f32::INFINITY, f32::min);
            // Some ten roundings of lengths up to 6 m.
            let error = (edge_distance(half, point) - least).abs();
            assert!(error < 4.0e-6, "{half} {point}: {error}");
        }
    }
}
