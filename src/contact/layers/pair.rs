//! Pairs of features: a vertex and a face, or two edges.

use bevy::math::{Vec3, Vec3A};

use super::members::State;
use crate::cloth::MapInline;
use crate::contact::colliders::{at, nearest_of_segments, nearest_to_point};

/// Split of a vertex and a face: the face's vertices belong to the second feature.
pub(super) const VERTEX_AND_FACE: usize = 1;
/// Split of two edges.
pub(super) const TWO_EDGES: usize = 2;

/// The nearest points of two features.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Nearest {
    /// Weights of the four particles in the vector from the second feature's point to the first's.
    pub weights: [f32; 4],
    /// Direction of that vector, of length 1; 0 if the points coincide.
    pub normal: Vec3A,
    /// Distance between the points (m).
    pub distance: f32,
}

impl Nearest {
    /// The nearest points of four particles; the first `split` are the first feature.
    #[inline]
    pub fn of(split: usize, places: [Vec3A; 4]) -> Self {
        let [a, b, c, d] = places.map_inline(Vec3::from);
        let weights = if split == VERTEX_AND_FACE {
            let [u, v, w] = nearest_to_point([b, c, d], a);
            [1.0, -u, -v, -w]
        } else {
            let (s, t) = nearest_of_segments([a, b], [c, d]);
            [1.0 - s, s, t - 1.0, -t]
        };
        let [p, q, r, s] = weights;
        let [a, b, c, d] = places;
        let between = a * p + b * q + c * r + d * s;
        let distance = between.length();
        let normal = if distance > 0.0 {
            between / distance
        } else {
            Vec3A::ZERO
        };
        Self {
            weights,
            normal,
            distance,
        }
    }

    /// Whether the nearest point is on an edge of the face, or at an end of an edge.
    #[inline]
    pub fn is_at_border(&self) -> bool {
        let mut weights = self.weights[1..].iter();
        !weights.all(|weight| weight.abs() > 0.0 && weight.abs() < 1.0)
    }
}

/// Two near features, with the data to keep them apart.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct NearPair {
    /// The vertex and the face's corners, or the two ends of each edge: indices of
    /// [`Members`](super::members::Members).
    pub members: [u32; 4],
    /// Number of the four that belong to the first feature.
    pub split: usize,
    /// Distance at which the features touch (m).
    pub thickness: f32,
    /// Coulomb's μ.
    pub friction: f32,
    /// Their nearest points when they were found.
    pub nearest: Nearest,
    /// Whether they are kept a thickness apart. Otherwise other pairs keep them apart, and they only must not pass
    /// through each other.
    pub is_pushed: bool,
}

impl NearPair {
    /// Gap between the two features along the normal (m): while it is positive, a plane separates them.
    #[inline]
    pub fn clearance(&self, states: [&State; 4]) -> f32 {
        let [a, b, c, d] = states.map_inline(|state| self.nearest.normal.dot(state.place));
        if self.split == VERTEX_AND_FACE {
            a - b.max(c).max(d)
        } else {
            a.min(b) - c.max(d)
        }
    }
}

/// Squared distance between a vertex and a face (m²).
pub(super) fn vertex_to_face(vertex: Vec3, face: [Vec3; 3]) -> f32 {
    at(face, nearest_to_point(face, vertex)).distance_squared(vertex)
}

/// Squared distance between two edges (m²).
pub(super) fn edge_to_edge(first: [Vec3; 2], second: [Vec3; 2]) -> f32 {
    let (s, t) = nearest_of_segments(first, second);
    first[0]
        .lerp(first[1], s)
        .distance_squared(second[0].lerp(second[1], t))
}
