//! How far a triangle may move before the edges of a shape can touch it.

use bevy::math::Vec3;

use super::{
    edge_contact::{BEYOND, DEEPEST, EdgeTest, FAR_SIDE, Placed, Plane, STEEP},
    geometry::SharpEdge,
};

/// A point of a triangle that reaches beyond its sides moves so many times as far as the farthest of its corners at most.
const LEVER: f32 = 1.0 + 4.0 * BEYOND;

/// How deep an edge counts grows with the longest side, and that by twice what a corner moves.
const GROWING: f32 = LEVER + 2.0 * DEEPEST;

/// An edge above this sine of its angle with the triangle may soon be steep.
const ALMOST_STEEP: f32 = 0.4;

/// How many times as long as a sine its arc is at most, up to where an edge is steep.
const ARC: f32 = 1.05;

/// A triangle whose normal leads out of the shape by more than this sine does not soon lead into it.
const SURELY: f32 = 0.3;

/// How a line lies to a triangle.
struct Line {
    /// Of its angle with the triangle's plane.
    sine: f32,
    /// How much the triangle's normal leads out of the shape there, from −1 to 1; 0 if that is not known.
    side: f32,
    /// How near it touches (m).
    near: f32,
}

/// How far a triangle's corners may move before edges can touch it.
pub(super) struct EdgeRoom {
    plane: Plane,
    /// How far each corner is from the side across (m).
    altitudes: Vec3,
    middle: Vec3,
    /// How far from its middle it reaches, beyond its sides too (m).
    size: f32,
    reach: f32,
    deepest: f32,
    /// More than this is not asked for (m).
    slack: f32,
    /// What all edges have left so far (m).
    left: f32,
    rounding: f32,
}

impl EdgeRoom {
    /// Of a tested triangle, as far as a `slack` (m).
    pub fn new(test: &EdgeTest, slack: f32) -> Self {
        let EdgeTest {
            plane,
            middle,
            longest,
            reach,
            ..
        } = *test;
        let [v, w] = plane.gradients;
        let steepness = Vec3::new((v + w).length(), v.length(), w.length());
        Self {
            plane,
            altitudes: steepness.recip(),
            middle,
            // The middle is at two thirds of each median, which is shorter than the longest side.
            size: (2.0 / 3.0) * (1.0 + 3.0 * BEYOND) * longest,
            reach,
            deepest: DEEPEST * longest,
            slack,
            left: slack,
            rounding: 1.0e-6 * (middle.length() + longest),
        }
    }

    /// How far they may move before any edge can (m).
    pub fn left(&self) -> f32 {
        self.left
    }

    /// Takes an edge into account.
    pub fn see(&mut self, edge: &SharpEdge) {
        self.left = self.left.min(self.of(edge));
    }

    /// How far they may move before an edge can touch (m), as far as the slack.
    pub fn of(&self, edge: &SharpEdge) -> f32 {
        let left = self.apart(edge);
        // Of rounding.
        left.min(self.slack) * (1.0 - 1.0e-4) - self.rounding
    }

    fn apart(&self, edge: &SharpEdge) -> f32 {
        let [begin, end] = edge.ends;
        let ends = [self.plane.place(begin), self.plane.place(end)];
        let near = self.reach + edge.radius;
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
        // Of a long edge, only what passes the triangle counts.
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

    /// How far they may move before a part of a line can touch (m): until it is near the triangle's plane, and over the triangle.
    ///
    /// As a triangle tilts, what is at a height over it goes beside it, and what is beside it goes up and down, by as much more as it
    /// is farther away than the lowest altitude.
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
        // As far as is asked for, an altitude loses a quarter of itself at most.
        let most = self.altitudes.min_element() / 8.0;
        let lowest = 6.0 * most;
        // Moved by so much, a triangle turns by twice as much of its lowest altitude.
        let turned = |angle: f32| angle / 2.0 * lowest;
        // What is inside of the shape comes out of it first; else it may have come through already.
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
            // What goes through the plane may touch the triangle's sides from beside it.
            let through = ((beside - far) / GROWING).max(above / (GROWING + 2.0 * far / lowest));
            over.min(through)
        } else {
            // An arc is longer than its sine by less than this up to where an edge is steep.
            over.min(turned(1.04 * STEEP - ARC * sine.max(0.0)))
        }
    }
}
