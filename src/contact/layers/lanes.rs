//! Squared distances of one feature from eight others at once.
//!
//! Rounded a little differently than those of [`Nearest`](super::pair::Nearest): good enough to tell which pairs to
//! list, not for their contact.

use std::ops::{Add, Mul, Sub};

use bevy::math::Vec3A;
use multiversion::multiversion;

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
            self.0[l] = if other.0[l] < self.0[l] {
                other.0[l]
            } else {
                self.0[l]
            };
        }
        self
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
    points.map(Lanes)
}

#[inline(always)]
fn splat(point: Vec3A) -> Vectors {
    [point.x, point.y, point.z].map(Lanes::all)
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

/// Squared distances of a vertex from eight faces (m²).
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
pub(super) fn vertex_to_faces(vertex: Vec3A, faces: &[Points; 3]) -> Eight {
    let vertex = splat(vertex);
    let [a, b, c] = [vectors(&faces[0]), vectors(&faces[1]), vectors(&faces[2])];
    let (ab, ac, bc) = (minus(&b, &a), minus(&c, &a), minus(&c, &b));
    let (from_a, from_b) = (minus(&vertex, &a), minus(&vertex, &b));
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
    plane.where_positive(inside, edges).min(edges).0
}

/// Squared distances of an edge from eight others (m²).
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
pub(super) fn edge_to_edges([p, q]: [Vec3A; 2], edges: &[Points; 2]) -> Eight {
    let (p, along) = (splat(p), splat(q - p));
    let (r, s) = (vectors(&edges[0]), vectors(&edges[1]));
    let (other, from) = (minus(&s, &r), minus(&p, &r));
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
    dot(&rest, &rest).0
}
