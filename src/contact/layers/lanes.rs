//! Finds near features of two patches: distances of one feature from eight others at once.
//!
//! Rounded a little differently than those of [`Nearest`](super::pair::Nearest): good enough to tell which pairs to
//! list, not for their contact.

use std::ops::{Add, Mul, Sub};

use multiversion::multiversion;

use super::bounds::Bounds;
use crate::cloth::MapInline;

/// Eight numbers.
#[derive(Debug, Clone, Copy)]
struct Lanes(Eight);

pub(super) type Eight = [f32; 8];

/// The points of eight features, by axis.
pub(super) type Points = [Eight; 3];

macro_rules! operator {
    ($trait:ident, $function:ident, $symbol:tt) => {
        impl $trait for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $function(mut self, other: Self) -> Self {
                for l in 0..8 {
                    self.0[l] $symbol other.0[l];
                }
                self
            }
        }
    };
}

operator!(Add, add, +=);
operator!(Sub, sub, -=);
operator!(Mul, mul, *=);

impl Lanes {
    #[inline(always)]
    fn all(number: f32) -> Self {
        Self([number; 8])
    }

    /// The reciprocals, or 0 for 0.
    #[inline(always)]
    fn inverse(mut self) -> Self {
        for l in 0..8 {
            let inverse = 1.0 / self.0[l];
            self.0[l] = if self.0[l] > 0.0 { inverse } else { 0.0 };
        }
        self
    }

    #[inline(always)]
    fn clamped(mut self) -> Self {
        for l in 0..8 {
            let least = if self.0[l] > 0.0 { self.0[l] } else { 0.0 };
            self.0[l] = if least < 1.0 { least } else { 1.0 };
        }
        self
    }

    #[inline(always)]
    fn min(mut self, other: Self) -> Self {
        for l in 0..8 {
            let is_less = other.0[l] < self.0[l];
            self.0[l] = if is_less { other.0[l] } else { self.0[l] };
        }
        self
    }

    #[inline(always)]
    fn max(mut self, other: Self) -> Self {
        for l in 0..8 {
            let is_more = other.0[l] > self.0[l];
            self.0[l] = if is_more { other.0[l] } else { self.0[l] };
        }
        self
    }

    /// These where they are greater than `far`, infinity elsewhere, also for NaN.
    #[inline(always)]
    fn beyond(mut self, far: f32) -> Self {
        for l in 0..8 {
            let is_far = self.0[l] > far;
            self.0[l] = if is_far { self.0[l] } else { f32::INFINITY };
        }
        self
    }

    /// Whether all are greater than `far`.
    #[inline(always)]
    fn are_beyond(&self, far: f32) -> bool {
        self.0
            .iter()
            .fold(true, |all, number| all & (*number > far))
    }

    /// These where `of` is not negative, `others` elsewhere.
    #[inline(always)]
    fn where_positive(mut self, of: Self, others: Self) -> Self {
        for l in 0..8 {
            self.0[l] = if of.0[l] >= 0.0 {
                self.0[l]
            } else {
                others.0[l]
            };
        }
        self
    }
}

type Vectors = [Lanes; 3];

#[inline(always)]
fn vectors(points: &Points) -> Vectors {
    points.map_inline(Lanes)
}

#[inline(always)]
fn minus(a: &Vectors, b: &Vectors) -> Vectors {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: &Vectors, b: &Vectors) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn off(from: &Vectors, along: &Vectors, by: Lanes) -> Vectors {
    [
        from[0] - along[0] * by,
        from[1] - along[1] * by,
        from[2] - along[2] * by,
    ]
}

/// Squared distance of a point from a segment: from its first end, of its own length squared, and along it.
#[inline(always)]
fn from_segment(from: &Vectors, along: &Vectors, square: Lanes, product: Lanes) -> Lanes {
    let rest = off(from, along, (product * square.inverse()).clamped());
    dot(&rest, &rest)
}

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
fn box_squares<const N: usize>(features: &[Points; N], bounds: &Bounds) -> Lanes {
    let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
    let mut squares = Lanes::all(0.0);
    for axis in 0..3 {
        let (mut least, mut most) = (Lanes(features[0][axis]), Lanes(features[0][axis]));
        for points in &features[1..] {
            least = least.min(Lanes(points[axis]));
            most = most.max(Lanes(points[axis]));
        }
        let above = least - Lanes::all(high[axis]);
        let gap = above.max(Lanes::all(low[axis]) - most).max(Lanes::all(0.0));
        squares = squares + gap * gap;
    }
    squares
}

/// Squared distances of a vertex from eight faces, or of an edge from eight others (m²).
#[inline(always)]
fn squares<const N: usize, const M: usize>(feature: &[Vectors; N], others: &[Points; M]) -> Lanes {
    if N == 1 {
        vertex_to_faces(&feature[0], [&others[0], &others[1], &others[2]])
    } else {
        edge_to_edges([&feature[0], &feature[1]], [&others[0], &others[1]])
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
    let mut least = Lanes::all(hits.least);
    for (from_second, others) in (0..).step_by(8).zip(other.points) {
        let from_own = box_squares(others, &own.bounds);
        if from_own.are_beyond(reach_squared) {
            least = least.min(from_own);
            continue;
        }
        for (from_first, group) in (0..).step_by(8).zip(own.points) {
            let from_other = box_squares(group, &other.bounds);
            least = least.min(from_other.beyond(reach_squared));
            for l in 0..(own.count - from_first).min(8) {
                if from_other.0[l] > reach_squared {
                    continue;
                }
                let mut feature = [[Lanes::all(0.0); 3]; N];
                for (point, eight) in feature.iter_mut().zip(group) {
                    *point = eight.map_inline(|axis| Lanes::all(axis[l]));
                }
                let squares = squares(&feature, others);
                hits.compared += 1;
                least = least.min(squares.beyond(reach_squared));
                if squares.are_beyond(reach_squared) {
                    continue;
                }
                for m in 0..(other.count - from_second).min(8) {
                    let square = squares.0[m];
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
    hits.least = least.0.into_iter().fold(f32::INFINITY, f32::min);
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

/// Squared distances of a vertex from eight faces (m²).
#[inline(always)]
fn vertex_to_faces(vertex: &Vectors, faces: [&Points; 3]) -> Lanes {
    let [a, b, c] = faces.map_inline(vectors);
    let (ab, ac, bc) = (minus(&b, &a), minus(&c, &a), minus(&c, &b));
    let (from_a, from_b) = (minus(vertex, &a), minus(vertex, &b));
    let (d00, d01, d11) = (dot(&ab, &ab), dot(&ab, &ac), dot(&ac, &ac));
    let (d20, d21) = (dot(&from_a, &ab), dot(&from_a, &ac));
    let area = d00 * d11 - d01 * d01;
    let v = d11 * d20 - d01 * d21;
    let w = d00 * d21 - d01 * d20;
    let inverse = area.inverse();
    let off_plane = off(&off(&from_a, &ab, v * inverse), &ac, w * inverse);
    let plane = dot(&off_plane, &off_plane);
    let edges = from_segment(&from_a, &ab, d00, d20)
        .min(from_segment(&from_a, &ac, d11, d21))
        .min(from_segment(&from_b, &bc, dot(&bc, &bc), dot(&from_b, &bc)));
    let inside = v.min(w).min(area - v - w);
    // A face without an area is its edges.
    plane.where_positive(inside, edges).min(edges)
}

/// Squared distances of an edge from eight others (m²).
#[inline(always)]
fn edge_to_edges([p, q]: [&Vectors; 2], edges: [&Points; 2]) -> Lanes {
    let along = minus(q, p);
    let [r, s] = edges.map_inline(vectors);
    let (other, from) = (minus(&s, &r), minus(p, &r));
    let (a, e, b) = (
        dot(&along, &along),
        dot(&other, &other),
        dot(&along, &other),
    );
    let (c, f) = (dot(&along, &from), dot(&other, &from));
    // Both lengths squared times the sine squared: 0 for parallel edges, which any point will do for.
    let product = a * e;
    let sine = product - b * b;
    let sine = sine.where_positive(sine - product * Lanes::all(1.0e-6), Lanes::all(0.0));
    let first = ((b * f - c * e) * sine.inverse()).clamped();
    let second = ((b * first + f) * e.inverse()).clamped();
    let first = ((b * second - c) * a.inverse()).clamped();
    let rest = [
        from[0] + along[0] * first - other[0] * second,
        from[1] + along[1] * first - other[1] * second,
        from[2] + along[2] * first - other[2] * second,
    ];
    dot(&rest, &rest)
}
