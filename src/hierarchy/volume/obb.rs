//! Oriented boxes.

use bevy::math::{Mat3, Vec3};

use super::{
    bounding::Volume,
    slabs::{self, Slab},
};
use crate::{
    cloth::{LANES, MapInline, View, X, Y, Z},
    hierarchy::probe::{Core, Probe, ROUNDING},
};

/// An oriented box: along a patch's rows and columns, and across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obb {
    /// Its middle (m).
    pub centre: Vec3,
    /// Its axes, of length 1 up to rounding errors.
    pub axes: Mat3,
    /// Half of its side lengths along them (m).
    pub half_size: Vec3,
}

impl Obb {
    const UNSET: Self = Self {
        centre: Vec3::ZERO,
        axes: Mat3::IDENTITY,
        half_size: Vec3::ZERO,
    };

    /// Its extent from the middle along `axis`, times the axis' length (m).
    #[inline(always)]
    pub(in crate::hierarchy) fn reach_along(&self, axis: Vec3) -> f32 {
        (self.axes.transpose() * axis).abs().dot(self.half_size)
    }

    /// Length (m) that determines the rounding errors of its sides.
    fn size(&self) -> f32 {
        self.centre.abs().max_element() + self.half_size.max_element()
    }

    /// The test of its three pairs of planes.
    fn slabs_may_reach(&self, probe: &Probe, reach: f32) -> bool {
        let slab = |axis: Vec3| {
            let (middle, half) = (self.centre.dot(axis), self.reach_along(axis));
            Slab {
                axis,
                low: middle - half,
                high: middle + half,
            }
        };
        let slabs = (0..3).map(|at| slab(self.axes.col(at)));
        slabs::may_reach(slabs, probe, reach, 3.0 * self.size())
    }

    fn position(view: &View, lane: usize) -> Vec3 {
        Vec3::new(view[X + lane], view[Y + lane], view[Z + lane])
    }
}

/// Axes along the rows and columns of a patch whose quarters have these middles, row by row. `None` if they coincide or
/// lie on one line. Orthogonal up to rounding errors, because boxes that contain their children need it.
fn axes_of([a, b, c, d]: [Vec3; 4]) -> Option<Mat3> {
    let (across, down) = ((b - a) + (d - c), (c - a) + (d - b));
    let x = across.try_normalize()?;
    let z = x.cross(down).try_normalize()?;
    // For a patch that is almost a line, the product is mostly rounding errors and may lean along x. A second
    // projection makes it orthogonal, unless it is only rounding errors.
    let lean = x.dot(z);
    let z = if lean.abs() < 0.5 {
        (z - x * lean).normalize()
    } else {
        x.any_orthonormal_vector()
    };
    Some(Mat3::from_cols(x, z.cross(x), z))
}

impl Volume for Obb {
    /// One by one: eight at once gain nothing because each has its own axes.
    type Lanes = [Self; LANES];

    const UNSET: Self::Lanes = [Self::UNSET; LANES];

    fn around(centre: Vec3, radius: f32) -> Self {
        let half_size = Vec3::splat(radius * ROUNDING);
        Self {
            centre,
            half_size,
            ..Self::UNSET
        }
    }

    fn unite(children: [&Self; 4]) -> Self {
        let axes = axes_of(children.map_inline(|child| child.centre)).unwrap_or(children[0].axes);
        // Relative to the first child, so that positions far from the origin lose no precision.
        let origin = children[0].centre;
        let (mut low, mut high) = (Vec3::MAX, Vec3::MIN);
        for child in children {
            let middle = axes.transpose() * (child.centre - origin);
            let reach = Vec3::from([0, 1, 2].map_inline(|at| child.reach_along(axes.col(at))));
            (low, high) = (low.min(middle - reach), high.max(middle + reach));
        }
        let centre = origin + axes * low.midpoint(high);
        let size = (high - low).max_element();
        // The middle is rounded by its coordinates, everything else by the box's size.
        let rounding = size * 2.0e-6 + centre.abs().max_element() * 8.0 * f32::EPSILON;
        Self {
            centre,
            axes,
            half_size: (high - low) / 2.0 + rounding,
        }
    }

    fn may_reach(&self, probe: &Probe, reach: f32) -> bool {
        match probe.core {
            Core::Point(centre) => {
                let local = self.axes.transpose() * (centre - self.centre);
                let reach = (reach + self.half_size.max_element() * 1.0e-5) * ROUNDING;
                local.distance_squared(local.clamp(-self.half_size, self.half_size))
                    <= reach * reach
            }
            Core::HalfSpace { point, normal } => {
                let offset = self.centre - point;
                let slack = (offset.length() + self.size()) * 1.0e-6;
                offset.dot(normal) - self.reach_along(normal) <= reach * ROUNDING + slack
            }
            Core::Segment([start, end]) => {
                // A ball around the segment as well: it is tighter for a collider that moves less than its size.
                let ball = slabs::ball_around(start, end, reach);
                self.may_reach(&ball, ball.radius) && self.slabs_may_reach(probe, reach)
            }
            Core::Cuboid { .. } => self.slabs_may_reach(probe, reach),
        }
    }

    fn inflated(&self, radius: f32) -> Self {
        Self {
            half_size: self.half_size + radius,
            ..*self
        }
    }

    fn of_particles(children: [&View; 4], into: &mut Self::Lanes) {
        for (lane, obb) in into.iter_mut().enumerate() {
            let [a, b, c, d] =
                children.map_inline(|child| Self::around(Self::position(child, lane), 0.0));
            *obb = Self::unite([&a, &b, &c, &d]);
        }
    }

    fn unite_lanes(children: [&Self::Lanes; 4], into: &mut Self::Lanes) {
        for (lane, obb) in into.iter_mut().enumerate() {
            *obb = Self::unite(children.map_inline(|child| &child[lane]));
        }
    }

    fn lane(lanes: &Self::Lanes, lane: usize) -> Self {
        lanes[lane]
    }

    fn set_lane(lanes: &mut Self::Lanes, lane: usize, volume: Self) {
        lanes[lane] = volume;
    }
}
