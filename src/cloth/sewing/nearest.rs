//! The nearest point of faces and segments.

use bevy::math::Vec3;

/// Weights of the point nearest to `point` on a face; a segment has its last corner twice.
fn weights([a, b, c]: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let inside = || {
        let normal = (b - a).cross(c - a);
        let area = normal.length_squared();
        let part = |p: Vec3, q: Vec3| (q - p).cross(point - p).dot(normal) / area;
        let weights = [part(b, c), part(c, a), part(a, b)];
        // Not of NaN.
        let is_inside = area > 0.0 && weights.iter().all(|&weight| weight >= 0.0);
        is_inside.then_some(weights)
    };
    if let Some(weights) = inside() {
        return weights;
    }
    let along = |p: Vec3, q: Vec3| {
        let long = (q - p).length_squared();
        let at = (point - p).dot(q - p) / long;
        let at = if long > 0.0 { at.clamp(0.0, 1.0) } else { 0.0 };
        (p.lerp(q, at).distance_squared(point), at)
    };
    let [(of_ab, ab), (of_bc, bc), (of_ca, ca)] = [along(a, b), along(b, c), along(c, a)];
    if of_ab <= of_bc && of_ab <= of_ca {
        [1.0 - ab, ab, 0.0]
    } else if of_bc <= of_ca {
        [0.0, 1.0 - bc, bc]
    } else {
        [ca, 0.0, 1.0 - ca]
    }
}

/// The point nearest to `point` on any face or segment, of particles at these places (m): its corners and weights. The first
/// of several that are as near.
pub(super) fn nearest(
    of: &[[u32; 3]],
    places: &[Vec3],
    point: Vec3,
) -> Option<([u32; 3], [f32; 3])> {
    let mut best = (f32::INFINITY, None);
    for &corners in of {
        let [a, b, c] = corners.map(|corner| places[corner as usize]);
        let weights = weights([a, b, c], point);
        let there = weights[0] * a + weights[1] * b + weights[2] * c;
        let square = there.distance_squared(point);
        if square < best.0 {
            best = (square, Some((corners, weights)));
        }
    }
    best.1
}
