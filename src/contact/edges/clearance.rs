//! Displacement of a triangle before the edges of a shape can touch it.

use bevy::math::Vec3;

use super::edge_contact::{BEYOND, DEEPEST, EdgeTest, FAR_SIDE, Placed, Plane, STEEP};
use crate::contact::colliders::SharpEdge;

/// Largest displacement of a point up to `BEYOND` outside a triangle's sides, relative to that of its corners.
const LEVER: f32 = 1.0 + 4.0 * BEYOND;

/// The largest depth of an edge grows with the longest side, by twice the displacement of a corner.
const GROWING: f32 = LEVER + 2.0 * DEEPEST;

/// Above this sine of its angle with the triangle, an edge may soon be steep.
const ALMOST_STEEP: f32 = 0.4;

/// Largest ratio of an arc to its sine, up to a steep edge.
const ARC: f32 = 1.05;

/// Above this sine, a triangle whose normal points out of the shape does not soon point into it.
const SURELY: f32 = 0.3;

/// A line relative to a triangle.
struct Line {
    /// Sine of its angle with the triangle's plane.
    sine: f32,
    /// Cosine of the triangle's normal with the outward direction there, from −1 to 1; 0 if unknown.
    side: f32,
    /// Distance at which it touches (m).
    near: f32,
}

/// Displacement of a triangle's corners before edges can touch it.
pub(crate) struct EdgeClearance {
    plane: Plane,
    /// Altitude of each corner over the opposite side (m).
    altitudes: Vec3,
    middle: Vec3,
    /// Reach from its middle, including `BEYOND` (m).
    size: f32,
    reach: f32,
    deepest: f32,
    /// Upper limit of the result (m).
    slack: f32,
    rounding: f32,
}

impl EdgeClearance {
    /// The clearance of a tested triangle, up to a `slack` (m).
    pub fn new(test: &EdgeTest, slack: f32) -> Self {
        let (plane, middle, longest) = (test.plane, test.middle, test.longest);
        let [v, w] = plane.gradients;
        let steepness = Vec3::new((v + w).length(), v.length(), w.length());
        Self {
            plane,
            altitudes: steepness.recip(),
            middle,
            // The middle is at two thirds of each median, which is shorter than the longest side.
            size: (2.0 / 3.0) * (1.0 + 3.0 * BEYOND) * longest,
            reach: test.reach,
            deepest: DEEPEST * longest,
            slack,
            rounding: 1.0e-6 * (middle.length() + longest),
        }
    }

    /// Displacement of the corners before an edge can touch (m), up to the slack.
    pub fn of(&self, edge: &SharpEdge) -> f32 {
        let left = self.apart(edge);
        // Smaller by rounding errors.
        left.min(self.slack) * (1.0 - 1.0e-4) - self.rounding
    }

    fn apart(&self, edge: &SharpEdge) -> f32 {
        let [begin, end] = edge.ends;
        let ends = [self.plane.place(begin), self.plane.place(end)];
        let near = self.reach * edge.part + edge.radius;
        let along = end - begin;
        let square = along.length_squared();
        let rise = (ends[0].height - ends[1].height).abs();
        let line = Line {
            sine: rise / square.sqrt(),
            side: self.plane.normal.dot(edge.outward),
            near,
        };
        let apart = self.between(ends, &line);
        if apart >= self.slack {
            return apart;
        }
        // Of a long edge, only the part near the triangle counts.
        let offset = self.middle - begin;
        let part = offset.dot(along) / square;
        let radius = self.size + LEVER * self.slack + near.max(self.deepest);
        let within = (radius * radius - offset.distance_squared(along * part)) / square;
        // NaN of a point.
        if within.is_nan() {
            return apart;
        }
        let half = within.max(0.0).sqrt();
        let [first, last] = [(part - half).max(0.0), (part + half).min(1.0)];
        if within <= 0.0 || first >= last {
            return self.slack;
        }
        let [from, to] = ends;
        self.between([from.lerp(to, first), from.lerp(to, last)], &line)
    }

    /// Displacement of the corners before a part of a line can touch (m): it has to be near the triangle's plane, and
    /// over the triangle.
    ///
    /// As a triangle tilts, a point over it moves sideways, and a point beside it moves up and down. The motion grows
    /// with its distance, relative to the lowest altitude.
    fn between(&self, [from, to]: [Placed; 2], line: &Line) -> f32 {
        let Line { sine, side, near } = *line;
        let beyond = Vec3::splat(-BEYOND) - from.weights.max(to.weights);
        let beside = (beyond * self.altitudes).max_element();
        let is_on_one_side = from.height * to.height > 0.0;
        let above = if is_on_one_side {
            from.height.abs().min(to.height.abs())
        } else {
            0.0
        };
        let far = near.max(self.deepest);
        // Up to the slack, an altitude shrinks by at most a quarter.
        let most = self.altitudes.min_element() / 8.0;
        let lowest = 6.0 * most;
        // A displacement of the corners turns the triangle by at most twice its ratio to the lowest altitude.
        let turned = |angle: f32| angle / 2.0 * lowest;
        // An edge inside the shape comes out of it first; otherwise it may have passed through already.
        let is_inside = is_on_one_side && side.abs() > SURELY && from.height * side < 0.0;
        let (margin, until) = if is_inside {
            (near, turned(side.abs() - FAR_SIDE))
        } else {
            (far, f32::INFINITY)
        };
        let tilt = LEVER + 2.0 * (far + LEVER * self.slack) / lowest;
        let over = (beside / tilt).max((above - margin) / GROWING).min(until);
        let over = over.min(most);
        // NaN of a point is not steep.
        if sine > ALMOST_STEEP {
            // An edge through the plane may touch the triangle's sides from beside it.
            let through = ((beside - far) / GROWING).max(above / (GROWING + 2.0 * far / lowest));
            over.min(through)
        } else {
            // An arc is longer than its sine by less than this up to where an edge is steep.
            over.min(turned(1.04 * STEEP - ARC * sine.max(0.0)))
        }
    }
}
