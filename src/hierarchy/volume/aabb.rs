//! Axis-aligned boxes in the cloth's frame.

use bevy::math::{
    Vec3, Vec3A,
    bounding::{Aabb3d, BoundingVolume},
};

use super::{
    bounding::Volume,
    slabs::{self, Slab},
};
use crate::{
    cloth::{LANES, Lanes, MapInline, View, X, Y, Z, larger, smaller},
    hierarchy::probe::{Core, Probe, ROUNDING},
};

impl Volume for Aabb3d {
    /// Minimum and maximum coordinates.
    type Lanes = [[Lanes; 3]; 2];

    const UNSET: Self::Lanes = [[[0.0; LANES]; 3]; 2];

    #[inline(always)]
    fn around(centre: Vec3, radius: f32) -> Self {
        // The rounding error of a coordinate, from subtracting and adding the radius. None without a radius.
        let half = if radius > 0.0 {
            Vec3::splat(radius) + centre.abs() * f32::EPSILON
        } else {
            Vec3::ZERO
        };
        Self {
            min: (centre - half).into(),
            max: (centre + half).into(),
        }
    }

    fn unite(children: [&Self; 4]) -> Self {
        let [a, b, c, d] = children;
        a.merge(b).merge(&c.merge(d))
    }

    #[inline(always)]
    fn may_reach(&self, probe: &Probe, reach: f32) -> bool {
        match probe.core {
            Core::Point(centre) => {
                let centre = Vec3A::from(centre);
                let reach = reach * ROUNDING;
                centre.distance_squared(centre.clamp(self.min, self.max)) <= reach * reach
            }
            Core::HalfSpace { point, normal } => {
                slabs::may_reach_half_space(point, normal, self.min.into(), self.max.into(), reach)
            }
            Core::Segment([start, end]) => {
                // A ball around the segment as well: it is tighter for a collider that moves less than its size.
                let ball = slabs::ball_around(start, end, reach);
                self.may_reach(&ball, ball.radius) && slabs_may_reach(self, probe, reach)
            }
            Core::Cuboid { .. } => slabs_may_reach(self, probe, reach),
        }
    }

    fn inflated(&self, radius: f32) -> Self {
        self.grow(Vec3A::splat(radius))
    }

    #[inline(always)]
    fn of_particles(children: [&View; 4], [low, high]: &mut Self::Lanes) {
        for (axis, from) in [X, Y, Z].into_iter().enumerate() {
            let [a, b, c, d] = children.map_inline(|child| coordinates(child, from));
            for l in 0..LANES {
                low[axis][l] = smaller(smaller(a[l], b[l]), smaller(c[l], d[l]));
                high[axis][l] = larger(larger(a[l], b[l]), larger(c[l], d[l]));
            }
        }
    }

    #[inline(always)]
    fn unite_lanes(children: [&Self::Lanes; 4], [low, high]: &mut Self::Lanes) {
        for axis in 0..3 {
            unite_slab(
                children.map_inline(|child| (&child[0][axis], &child[1][axis])),
                &mut low[axis],
                &mut high[axis],
            );
        }
    }

    #[inline(always)]
    fn lane(lanes: &Self::Lanes, lane: usize) -> Self {
        let corner = |side: &[Lanes; 3]| Vec3A::new(side[0][lane], side[1][lane], side[2][lane]);
        Self {
            min: corner(&lanes[0]),
            max: corner(&lanes[1]),
        }
    }

    fn set_lane(lanes: &mut Self::Lanes, lane: usize, volume: Self) {
        for (side, corner) in lanes.iter_mut().zip([volume.min, volume.max]) {
            for (at, value) in corner.to_array().into_iter().enumerate() {
                side[at][lane] = value;
            }
        }
    }
}

/// The test of a box's three pairs of planes.
fn slabs_may_reach(aabb: &Aabb3d, probe: &Probe, reach: f32) -> bool {
    let slab = |at: usize| Slab {
        axis: Vec3::AXES[at],
        low: aabb.min[at],
        high: aabb.max[at],
    };
    let size = aabb.min.abs().max(aabb.max.abs()).max_element();
    slabs::may_reach([0, 1, 2].into_iter().map(slab), probe, reach, size)
}

/// Eight numbers of a block from an offset on.
#[inline(always)]
pub(super) fn coordinates(view: &View, from: usize) -> &Lanes {
    view[from..].first_chunk().expect("24 numbers")
}

/// The union of four intervals along an axis.
#[inline(always)]
pub(super) fn unite_slab(children: [(&Lanes, &Lanes); 4], low: &mut Lanes, high: &mut Lanes) {
    let [a, b, c, d] = children;
    for l in 0..LANES {
        low[l] = smaller(smaller(a.0[l], b.0[l]), smaller(c.0[l], d.0[l]));
        high[l] = larger(larger(a.1[l], b.1[l]), larger(c.1[l], d.1[l]));
    }
}
