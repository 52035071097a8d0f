//! Finds near features of two patches: distances of one feature from eight others at once.
//!
//! Rounded a little differently than those of [`Nearest`](super::pair::Nearest): good enough to tell which pairs to
//! list, not for their contact.

use bevy::math::Vec3;
use multiversion::multiversion;

use super::bounds::Bounds;
use crate::cloth::{larger, smaller};

/// Eight numbers.
pub(super) type Eight = [f32; 8];

/// The points of eight features, by axis.
pub(super) type Points = [Eight; 3];

/// The features of a patch, in groups of eight; the last one fills the last group.
pub(super) struct Groups<'a, const N: usize> {
    pub points: &'a [[Points; N]],
    pub count: usize,
    /// A box around them.
    pub bounds: Bounds,
}

impl<'a, const N: usize> Groups<'a, N> {
    pub fn of(points: &'a [Points], count: usize, bounds: Bounds) -> Self {
        Self {
            points: points.as_chunks().0,
            count,
            bounds,
        }
    }
}

/// Two near features, by their places in their patches, and their squared distance (m²).
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    pub first: usize,
    pub second: usize,
    pub square: f32,
}

/// Near features of two patches.
#[derive(Debug, Default, Clone)]
pub(super) struct Hits {
    pub of: Vec<Hit>,
    /// Lower bound of the squared distances of all others (m²).
    pub least: f32,
    /// Number of features that were compared with eight others.
    pub compared: usize,
}

/// Squared distances of eight features from a box (m²), at least.
#[inline(always)]
fn box_squares<const N: usize>(features: &[Points; N], bounds: &Bounds) -> Eight {
    let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
    let mut squares = [0.0; 8];
    for axis in 0..3 {
        for l in 0..8 {
            let (mut least, mut most) = (features[0][axis][l], features[0][axis][l]);
            for points in &features[1..] {
                least = smaller(points[axis][l], least);
                most = larger(points[axis][l], most);
            }
            let gap = larger(0.0, larger(low[axis] - most, least - high[axis]));
            squares[l] += gap * gap;
        }
    }
    squares
}

/// Squared distances of a vertex from eight faces, or of an edge from eight others (m²).
#[inline(always)]
fn squares<const N: usize, const M: usize>(feature: &[Vec3; N], others: &[Points; M]) -> Eight {
    let mut squares = [0.0; 8];
    for (l, square) in squares.iter_mut().enumerate() {
        let of = |point: usize| point_of(&others[point], l);
        *square = if N == 1 {
            vertex_to_face(feature[0], [of(0), of(1), of(2)])
        } else {
            edge_to_edge([feature[0], feature[1]], [of(0), of(1)])
        };
    }
    squares
}

#[inline(always)]
fn point_of(points: &Points, l: usize) -> Vec3 {
    Vec3::new(points[0][l], points[1][l], points[2][l])
}

/// Whether all are greater than `far`.
#[inline(always)]
fn are_beyond(squares: &Eight, far: f32) -> bool {
    squares
        .iter()
        .fold(true, |all, square| all & (*square > far))
}

/// Lowers `least` to those that are greater than `far`. NaN is not.
#[inline(always)]
fn lower(least: &mut Eight, squares: &Eight, far: f32) {
    for l in 0..8 {
        let beyond = if squares[l] > far {
            squares[l]
        } else {
            f32::INFINITY
        };
        least[l] = smaller(beyond, least[l]);
    }
}

/// Finds the features that are no farther apart than the square root of `reach_squared`, also those at NaN. Features that are farther
/// from the box of all others are not compared.
#[inline(always)]
fn near<const N: usize, const M: usize>(
    own: &Groups<N>,
    other: &Groups<M>,
    reach_squared: f32,
    hits: &mut Hits,
) {
    let mut least = [hits.least; 8];
    for (from_second, others) in (0..).step_by(8).zip(other.points) {
        let from_own = box_squares(others, &own.bounds);
        if are_beyond(&from_own, reach_squared) {
            lower(&mut least, &from_own, reach_squared);
            continue;
        }
        for (from_first, group) in (0..).step_by(8).zip(own.points) {
            let from_other = box_squares(group, &other.bounds);
            lower(&mut least, &from_other, reach_squared);
            for (l, &from_box) in from_other.iter().enumerate().take(own.count - from_first) {
                if from_box > reach_squared {
                    continue;
                }
                let mut feature = [Vec3::ZERO; N];
                for (point, eight) in feature.iter_mut().zip(group) {
                    *point = point_of(eight, l);
                }
                let squares = squares(&feature, others);
                hits.compared += 1;
                lower(&mut least, &squares, reach_squared);
                if are_beyond(&squares, reach_squared) {
                    continue;
                }
                for (m, &square) in squares.iter().enumerate().take(other.count - from_second) {
                    if square > reach_squared {
                        continue;
                    }
                    // Also for NaN.
                    hits.of.push(Hit {
                        first: from_first + l,
                        second: from_second + m,
                        square,
                    });
                }
            }
        }
    }
    hits.least = least.into_iter().fold(f32::INFINITY, f32::min);
}

/// Finds the faces that are no farther from vertices than the square root of `reach_squared`.
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
pub(super) fn near_faces(
    vertices: &Groups<1>,
    faces: &Groups<3>,
    reach_squared: f32,
    hits: &mut Hits,
) {
    near(vertices, faces, reach_squared, hits);
}

/// Finds the edges that are no farther from others than the square root of `reach_squared`.
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
pub(super) fn near_edges(
    edges: &Groups<2>,
    others: &Groups<2>,
    reach_squared: f32,
    hits: &mut Hits,
) {
    near(edges, others, reach_squared, hits);
}

/// Squared distance of a vertex from a face (m²).
#[inline(always)]
fn vertex_to_face(vertex: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let (from_a, from_b) = (vertex - a, vertex - b);
    let (d00, d01, d11) = (ab.dot(ab), ab.dot(ac), ac.dot(ac));
    let (d20, d21) = (from_a.dot(ab), from_a.dot(ac));
    let area = d00 * d11 - d01 * d01;
    let v = d11 * d20 - d01 * d21;
    let w = d00 * d21 - d01 * d20;
    let by_area = inverse(area);
    let off_plane = from_a - ab * (v * by_area) - ac * (w * by_area);
    let plane = off_plane.dot(off_plane);
    let edges = smaller(
        from_segment(from_b, bc, bc.dot(bc), from_b.dot(bc)),
        smaller(
            from_segment(from_a, ac, d11, d21),
            from_segment(from_a, ab, d00, d20),
        ),
    );
    let inside = smaller(area - v - w, smaller(w, v));
    // A face without an area is its edges.
    let face = if inside >= 0.0 { plane } else { edges };
    smaller(edges, face)
}

/// Squared distance of two edges (m²).
#[inline(always)]
fn edge_to_edge([p, q]: [Vec3; 2], [r, s]: [Vec3; 2]) -> f32 {
    let (along, other, from) = (q - p, s - r, p - r);
    let (a, e, b) = (along.dot(along), other.dot(other), along.dot(other));
    let (c, f) = (along.dot(from), other.dot(from));
    // Both lengths squared times the sine squared: 0 for parallel edges, which any point will do for.
    let product = a * e;
    let sine = product - b * b;
    let sine = if sine - product * 1.0e-6 >= 0.0 {
        sine
    } else {
        0.0
    };
    let first = clamped((b * f - c * e) * inverse(sine));
    let second = clamped((b * first + f) * inverse(e));
    let first = clamped((b * second - c) * inverse(a));
    let rest = from + along * first - other * second;
    rest.dot(rest)
}

/// Squared distance of a point from a segment: from its first end, of its own length squared, and along it.
#[inline(always)]
fn from_segment(from: Vec3, along: Vec3, square: f32, product: f32) -> f32 {
    let rest = from - along * clamped(product * inverse(square));
    rest.dot(rest)
}

/// The reciprocal of a number greater than 0, otherwise 0.
#[inline(always)]
fn inverse(number: f32) -> f32 {
    let inverse = 1.0 / number;
    if number > 0.0 { inverse } else { 0.0 }
}

/// From 0 to 1.
#[inline(always)]
fn clamped(number: f32) -> f32 {
    smaller(larger(number, 0.0), 1.0)
}
