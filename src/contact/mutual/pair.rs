//! Pairs of features that may come near each other.

use bevy::math::{Vec3, Vec3A};

use super::members::State;
use crate::contact::triangle::{at, nearest_of_segments, nearest_to_point};

/// A vertex and a face, or two edges, of one cloth or of two.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Pair {
    /// The vertex and the face's corners, or the two ends of each edge: indices of
    /// [`Members`](super::members::Members).
    pub members: [u32; 4],
    /// Number of the four that belong to the first feature.
    pub split: usize,
    /// Distance at which the features touch (m).
    pub thickness: f32,
    /// Coulomb's μ.
    pub friction: f32,
    /// The previous pair of the same vertex with another face; or [`NOBODY`].
    pub before: u32,
    /// Total distance that its particles have to travel before it can touch (m).
    pub far_until: f32,
    /// Whether it was near in the last test.
    pub is_near: bool,
    /// The nearest points when they were last found, and the sub-step; or [`NOBODY`].
    pub nearest: Nearest,
    pub found_in: u32,
}

/// The nearest points of two features.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Nearest {
    /// Weights of the four particles in the vector from the second feature's point to the first's.
    pub weights: [f32; 4],
    /// Direction of that vector, of length 1; 0 if the points coincide.
    pub normal: Vec3,
    /// Distance between the points (m).
    pub distance: f32,
}

/// No member, no pair.
pub(super) const NOBODY: u32 = u32::MAX;
/// Split of a vertex and a face: the face's vertices belong to the second feature.
pub(super) const VERTEX_AND_FACE: usize = 1;
/// Split of two edges.
pub(super) const TWO_EDGES: usize = 2;

impl Nearest {
    /// The nearest points of four particles; the first `split` are the first feature.
    #[inline]
    pub fn of(split: usize, [a, b, c, d]: [Vec3; 4]) -> Self {
        let weights = if split == VERTEX_AND_FACE {
            let [u, v, w] = nearest_to_point([b, c, d], a);
            [1.0, -u, -v, -w]
        } else {
            let (s, t) = nearest_of_segments([a, b], [c, d]);
            [1.0 - s, s, t - 1.0, -t]
        };
        let between = combined(weights, [a, b, c, d]);
        let distance = between.length();
        let normal = if distance > 0.0 {
            between / distance
        } else {
            Vec3::ZERO
        };
        Self {
            weights,
            normal,
            distance,
        }
    }
}

/// Two near features, with the data to keep them apart.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct NearPair {
    /// As in [`Pair`].
    pub members: [u32; 4],
    pub split: usize,
    pub thickness: f32,
    pub friction: f32,
    /// The distance of their nearest points when they were found (m), its direction, and the weights of the four
    /// particles.
    pub distance: f32,
    pub normal: Vec3A,
    pub weights: [f32; 4],
    /// Whether they are kept a thickness apart. Otherwise other pairs keep them apart, and they only must not pass
    /// through each other.
    pub is_pushed: bool,
}

impl NearPair {
    pub fn of(pair: &Pair) -> Self {
        Self {
            members: pair.members,
            split: pair.split,
            thickness: pair.thickness,
            friction: pair.friction,
            distance: pair.nearest.distance,
            normal: pair.nearest.normal.into(),
            weights: pair.nearest.weights,
            is_pushed: true,
        }
    }

    /// Approach until `part` of their thickness is left (m).
    pub fn until_met(&self, part: f32) -> f32 {
        self.distance - part * self.thickness
    }

    /// Gap between the two features along the normal (m): while it is positive, a plane separates them.
    #[inline]
    pub fn clearance(&self, states: [&State; 4]) -> f32 {
        let [a, b, c, d] = states.map(|state| self.normal.dot(state.place));
        if self.split == VERTEX_AND_FACE {
            a - b.max(c).max(d)
        } else {
            a.min(b) - c.max(d)
        }
    }
}

fn combined([p, q, r, s]: [f32; 4], [a, b, c, d]: [Vec3; 4]) -> Vec3 {
    a * p + b * q + c * r + d * s
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
