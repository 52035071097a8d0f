//! Bounding spheres.

use bevy::math::{Vec3, Vec3A, bounding::BoundingSphere, primitives::Sphere};

use super::bounding::Volume;
use crate::{
    cloth::{LANES, Lanes, MapInline, View, X, Y, Z, larger},
    hierarchy::probe::Probe,
};

/// Growth factor of a radius on each level, beyond the rounding error of its own sum and root.
const LEVEL_ROUNDING: f32 = 1.0 + 4.0 * f32::EPSILON;

impl Volume for BoundingSphere {
    /// Centre and radius.
    type Lanes = [Lanes; 4];

    const UNSET: Self::Lanes = [[0.0; LANES]; 4];

    #[inline(always)]
    fn around(centre: Vec3, radius: f32) -> Self {
        Self::new(Vec3A::from(centre), radius)
    }

    /// The smallest radius around the mean of the centres.
    fn unite(children: [&Self; 4]) -> Self {
        let centre = children.iter().map(|child| child.center).sum::<Vec3A>() / 4.0;
        let reach = |child: &&Self| centre.distance(child.center) + child.radius();
        let radius = children.iter().map(reach).fold(0.0, f32::max);
        Self::new(centre, radius * LEVEL_ROUNDING)
    }

    #[inline(always)]
    fn may_reach(&self, probe: &Probe, reach: f32) -> bool {
        probe
            .core
            .may_reach(self.center.into(), self.radius() + reach)
    }

    fn inflated(&self, radius: f32) -> Self {
        Self::new(self.center, self.radius() + radius)
    }

    #[inline(always)]
    fn of_particles(children: [&View; 4], into: &mut Self::Lanes) {
        let [a, b, c, d] = children;
        for l in 0..LANES {
            let [x, y, z] = [X, Y, Z]
                .map_inline(|at| ((a[at + l] + b[at + l]) + (c[at + l] + d[at + l])) / 4.0);
            let square = |child: &View| {
                let (x, y, z) = (child[X + l] - x, child[Y + l] - y, child[Z + l] - z);
                x * x + y * y + z * z
            };
            let farthest = larger(larger(square(a), square(b)), larger(square(c), square(d)));
            (into[0][l], into[1][l], into[2][l]) = (x, y, z);
            into[3][l] = farthest.sqrt() * LEVEL_ROUNDING;
        }
    }

    #[inline(always)]
    fn unite_lanes(children: [&Self::Lanes; 4], into: &mut Self::Lanes) {
        let [a, b, c, d] = children;
        for l in 0..LANES {
            let [x, y, z] =
                [0, 1, 2].map_inline(|at| ((a[at][l] + b[at][l]) + (c[at][l] + d[at][l])) / 4.0);
            let reach = |child: &Self::Lanes| {
                let (x, y, z) = (child[0][l] - x, child[1][l] - y, child[2][l] - z);
                (x * x + y * y + z * z).sqrt() + child[3][l]
            };
            let radius = larger(larger(reach(a), reach(b)), larger(reach(c), reach(d)));
            (into[0][l], into[1][l], into[2][l]) = (x, y, z);
            into[3][l] = radius * LEVEL_ROUNDING;
        }
    }

    #[inline(always)]
    fn lane(lanes: &Self::Lanes, lane: usize) -> Self {
        let [x, y, z, radius] = [0, 1, 2, 3].map_inline(|at| lanes[at][lane]);
        Self {
            center: Vec3A::new(x, y, z),
            sphere: Sphere { radius },
        }
    }

    fn set_lane(lanes: &mut Self::Lanes, lane: usize, volume: Self) {
        let [x, y, z] = volume.center.to_array();
        for (at, value) in [x, y, z, volume.radius()].into_iter().enumerate() {
            lanes[at][lane] = value;
        }
    }
}
