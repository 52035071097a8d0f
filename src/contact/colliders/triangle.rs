//! Nearest points between a triangle and a point or a segment.

use bevy::math::Vec3;

use crate::cloth::MapInline;

/// The nearest points of a triangle and a core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearestPoints {
    /// Barycentric weights of the triangle's point; their sum is 1.
    pub weights: [f32; 3],
    /// Vector from the core's point to the triangle's (m).
    pub offset: Vec3,
    /// Position of the core's point along the segment, from 0 to 1.
    pub along: f32,
}

impl NearestPoints {
    fn nearer(self, other: Self) -> Self {
        let is_nearer = other.offset.length_squared() < self.offset.length_squared();
        if is_nearer { other } else { self }
    }
}

/// The point of the triangle with these weights.
pub(crate) fn at([a, b, c]: [Vec3; 3], [u, v, w]: [f32; 3]) -> Vec3 {
    a * u + b * v + c * w
}

/// Weights of the point of a triangle that is nearest to `point`, by its Voronoi region: a corner, an edge or the face
/// (Ericson 2005, chapter 5).
pub(crate) fn nearest_to_point([a, b, c]: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let (ab, ac) = (b - a, c - a);
    let longest = ab
        .length_squared()
        .max(ac.length_squared())
        .max(b.distance_squared(c));
    // For a line or a point, rounding destroys the regions: the nearest of the edges.
    if ab.cross(ac).length_squared() <= 1.0e-9 * longest * longest {
        return nearest_of_edges([a, b, c], point);
    }
    let from_a = point - a;
    let (d1, d2) = (ab.dot(from_a), ac.dot(from_a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let from_b = point - b;
    let (d3, d4) = (ab.dot(from_b), ac.dot(from_b));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let along_ab = d1 * d4 - d3 * d2;
    if along_ab <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = ratio(d1, d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let from_c = point - c;
    let (d5, d6) = (ab.dot(from_c), ac.dot(from_c));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let along_ac = d5 * d2 - d1 * d6;
    if along_ac <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = ratio(d2, d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let along_bc = d3 * d6 - d5 * d4;
    if along_bc <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let sum = along_bc + along_ac + along_ab;
    let (v, w) = (ratio(along_ac, sum), ratio(along_ab, sum));
    [1.0 - v - w, v, w]
}

/// Weights of the point of a triangle's edges that is nearest to `point`.
fn nearest_of_edges(triangle: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let mut nearest = ([1.0, 0.0, 0.0], f32::INFINITY);
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let along = triangle[to] - triangle[from];
        let part = ratio((point - triangle[from]).dot(along), along.length_squared());
        let mut weights = [0.0; 3];
        (weights[from], weights[to]) = (1.0 - part, part);
        let distance = at(triangle, weights).distance_squared(point);
        if distance < nearest.1 {
            nearest = (weights, distance);
        }
    }
    nearest.0
}

/// An edge of zero length gives 0.
fn ratio(part: f32, whole: f32) -> f32 {
    if whole == 0.0 {
        0.0
    } else {
        (part / whole).clamp(0.0, 1.0)
    }
}

/// The nearest points of a triangle and a segment, which may be a point.
pub(crate) fn nearest(triangle: [Vec3; 3], segment: [Vec3; 2]) -> NearestPoints {
    let [start, end] = segment;
    let span = end - start;
    let square = span.length_squared();
    // NaN of a segment that is a point.
    let along = triangle.map_inline(|corner| (corner - start).dot(span) / square);
    if along.iter().all(|along| *along <= 0.0) {
        nearest_along(triangle, start, 0.0)
    } else if along.iter().all(|along| *along >= 1.0) {
        nearest_along(triangle, end, 1.0)
    } else if along.iter().all(|along| (0.0..=1.0).contains(along)) {
        // Seen along the segment, they are those of a triangle and a point.
        let seen = [0, 1, 2].map_inline(|corner| (triangle[corner] - start) - span * along[corner]);
        let weights = nearest_to_point(seen, Vec3::ZERO);
        let along: f32 = (0..3).map(|corner| weights[corner] * along[corner]).sum();
        NearestPoints {
            weights,
            offset: at(seen, weights),
            along: along.clamp(0.0, 1.0),
        }
    } else {
        nearest_of_parts(triangle, segment)
    }
}

/// The point of a triangle that is nearest to a point `along` a segment.
fn nearest_along(triangle: [Vec3; 3], point: Vec3, along: f32) -> NearestPoints {
    let weights = nearest_to_point(triangle, point);
    NearestPoints {
        weights,
        offset: at(triangle, weights) - point,
        along,
    }
}

/// The nearest points of a triangle and a segment: of all pairs of corner, edge and face with an end or the segment.
fn nearest_of_parts(triangle: [Vec3; 3], [start, end]: [Vec3; 2]) -> NearestPoints {
    let mut found = nearest_along(triangle, start, 0.0);
    if start == end {
        return found;
    }
    found = found.nearer(nearest_along(triangle, end, 1.0));
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let (s, t) = nearest_of_segments([triangle[from], triangle[to]], [start, end]);
        let mut weights = [0.0; 3];
        (weights[from], weights[to]) = (1.0 - s, s);
        let offset = at(triangle, weights) - start.lerp(end, t);
        found = found.nearer(NearestPoints {
            weights,
            offset,
            along: t,
        });
    }
    // If the segment passes through the face, they are nearest there.
    let [a, b, c] = triangle;
    let normal = (b - a).cross(c - a);
    let (before, after) = ((start - a).dot(normal), (end - a).dot(normal));
    if before * after < 0.0 {
        let along = before / (before - after);
        found = found.nearer(nearest_along(triangle, start.lerp(end, along), along));
    }
    found
}

/// Positions of the nearest points along two segments, from 0 to 1.
pub(crate) fn nearest_of_segments([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> (f32, f32) {
    let (ab, cd, ca) = (b - a, d - c, a - c);
    let (aa, ee, f) = (ab.length_squared(), cd.length_squared(), cd.dot(ca));
    let (along, across) = (ab.dot(ca), ab.dot(cd));
    let parallel = aa * ee - across * across;
    let clamp = |value: f32| match value.is_finite() {
        true => value.clamp(0.0, 1.0),
        false => 0.0,
    };
    let mut s = if parallel > 0.0 {
        clamp((across * f - along * ee) / parallel)
    } else {
        0.0
    };
    let t = (across * s + f) / ee;
    let clamped = clamp(t);
    if t != clamped {
        s = clamp((across * clamped - along) / aa);
    }
    (s, clamped)
}

/// Area (m²) of the part of a triangle within `radius` of a point of its plane: sectors and triangles from that point,
/// one pair for each edge.
pub(crate) fn area_within(corners: [Vec3; 3], centre: Vec3, radius: f32) -> f32 {
    let [a, b, c] = corners;
    let Some(normal) = (b - a).cross(c - a).try_normalize() else {
        return 0.0;
    };
    let edge = |from: Vec3, to: Vec3| {
        let (from, to) = (from - centre, to - centre);
        let angle = |p: Vec3, q: Vec3| normal.dot(p.cross(q)).atan2(p.dot(q));
        let sector = |p: Vec3, q: Vec3| radius * radius / 2.0 * angle(p, q);
        let along = to - from;
        let (quadratic, linear) = (along.length_squared(), from.dot(along));
        let root = linear * linear - quadratic * (from.length_squared() - radius * radius);
        if root <= 0.0 || quadratic == 0.0 {
            return sector(from, to);
        }
        let [enter, leave] = [-root.sqrt(), root.sqrt()]
            .map_inline(|root| ((root - linear) / quadratic).clamp(0.0, 1.0));
        let (inside, outside) = (from + along * enter, from + along * leave);
        sector(from, inside) + normal.dot(inside.cross(outside)) / 2.0 + sector(outside, to)
    };
    (edge(a, b) + edge(b, c) + edge(c, a)).abs()
}

/// Area of the triangle inside a ball (m²), and ∫ depth dA over it (m³), with a cap's mean depth of half its height.
pub(crate) fn cap(corners: [Vec3; 3], centre: Vec3, radius: f32) -> (f32, f32) {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let height = normal.dot(a - centre);
    let within = radius * radius - height * height;
    if within <= 0.0 {
        return (0.0, 0.0);
    }
    let area = area_within(corners, centre + normal * height, within.sqrt());
    (area, area * (radius - height.abs()) / 2.0)
}
