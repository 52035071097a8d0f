//! Tests of volumes between pairs of parallel planes.

use bevy::math::Vec3;

use crate::hierarchy::probe::{Core, Probe, ROUNDING};

/// The interval of a volume along an axis: projections on the axis, whose length need not be 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    pub axis: Vec3,
    pub low: f32,
    pub high: f32,
}

/// Whether a volume between `slabs` may be within `reach` (m) of the probe's core: false if the core's distance from
/// any slab is larger. `size` is the largest coordinate (m), for rounding errors.
pub fn may_reach(slabs: impl Iterator<Item = Slab>, probe: &Probe, reach: f32, size: f32) -> bool {
    let reach = reach * ROUNDING + probe.core.size() * 1.0e-5 + size * 8.0 * f32::EPSILON;
    // The part of a segment between all pairs of planes so far.
    let (mut from, mut to) = (0.0_f32, 1.0_f32);
    for Slab { axis, low, high } in slabs {
        let reach = reach * axis.length();
        let (low, high) = (low - reach, high + reach);
        if let Core::Segment([a, b]) = probe.core {
            let (start, along) = (a.dot(axis), b.dot(axis) - a.dot(axis));
            let (enter, leave) = ((low - start) / along, (high - start) / along);
            if along == 0.0 || !(enter.is_finite() && leave.is_finite()) {
                if start.max(start + along) < low || start.min(start + along) > high {
                    return false;
                }
            } else {
                // A fraction of 1e-5 of the segment is already included in `reach`.
                from = from.max(enter.min(leave) - 1.0e-5);
                to = to.min(enter.max(leave) + 1.0e-5);
                if from > to {
                    return false;
                }
            }
        } else {
            let (core_low, core_high) = probe.core.interval(axis);
            if core_high < low || core_low > high {
                return false;
            }
        }
    }
    true
}

/// Whether a box from `low` to `high` in the frame's coordinates may be within `reach` of a half-space.
pub fn may_reach_half_space(point: Vec3, normal: Vec3, low: Vec3, high: Vec3, reach: f32) -> bool {
    let nearest = Vec3::select(normal.cmplt(Vec3::ZERO), high, low);
    let offset = nearest - point;
    let slack = (offset.length() + nearest.length()) * 1.0e-6;
    offset.dot(normal) <= reach * ROUNDING + slack
}

/// A ball around all that is within reach of a segment: a volume beyond it needs no test against slabs.
pub fn ball_around(start: Vec3, end: Vec3, reach: f32) -> Probe {
    let radius = reach + start.distance(end) / 2.0 * ROUNDING;
    Probe::ball(start.midpoint(end), radius, 0.0)
}
