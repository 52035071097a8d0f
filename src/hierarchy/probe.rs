//! What a tree is searched for.

use bevy::{
    math::{DQuat, DVec3, Isometry3d, Mat3, Vec3},
    reflect::Reflect,
};

use crate::cloth::{LANES, View, X, Y, Z};

/// What a length grows by so that rounding in `f32` never makes a bound too small. A bound and the test against
/// it take fewer than 20 roundings of half an ε each; this is 84 ε.
pub(crate) const ROUNDING: f32 = 1.0 + 1.0e-5;

/// What a [`Probe`] is a neighbourhood of.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
pub enum Core {
    /// A point: the probe is a ball.
    Point(Vec3),
    /// All points between two (m): the probe is a capsule.
    Segment([Vec3; 2]),
    /// A box: the probe is a rounded one.
    Cuboid {
        /// Its middle (m) and axes.
        pose: Isometry3d,
        /// Half of its lengths along its axes (m).
        half_size: Vec3,
    },
    /// All that is behind a plane.
    HalfSpace {
        /// A point of the plane (m).
        point: Vec3,
        /// Away from what is behind it, of length 1.
        normal: Vec3,
    },
}

impl Core {
    /// Vector from the nearest point of the core to `point` (m), in `f64`. In a half-space it points inwards, and is
    /// as long as the point is deep.
    fn offset(&self, point: Vec3) -> DVec3 {
        let point = point.as_dvec3();
        match *self {
            Self::Point(centre) => point - centre.as_dvec3(),
            Self::Segment([a, b]) => {
                let (a, b) = (a.as_dvec3(), b.as_dvec3());
                let (offset, along) = (point - a, b - a);
                let t = (offset.dot(along) / along.length_squared()).clamp(0.0, 1.0);
                // A segment of no length is its first end.
                if t > 0.0 { offset - along * t } else { offset }
            }
            Self::Cuboid { pose, half_size } => {
                let rotation =
                    DQuat::from_array(pose.rotation.to_array().map(f64::from)).normalize();
                let offset = point - Vec3::from(pose.translation).as_dvec3();
                let local = rotation.inverse() * offset;
                let half = half_size.as_dvec3();
                local - local.clamp(-half, half)
            }
            Self::HalfSpace { point: on, normal } => {
                let normal = normal.as_dvec3();
                normal * (point - on.as_dvec3()).dot(normal)
            }
        }
    }

    /// How far `point` is from the core (m), in `f64`: 0 inside, less than 0 behind a half-space's plane.
    pub fn distance(&self, point: Vec3) -> f64 {
        let offset = self.offset(point);
        match self {
            Self::HalfSpace { normal, .. } => offset.dot(normal.as_dvec3()),
            _ => offset.length(),
        }
    }

    /// Length (m) to whose rounding a distance from this core is exact.
    pub(crate) fn size(&self) -> f32 {
        match self {
            Self::Point(_) | Self::HalfSpace { .. } => 0.0,
            Self::Segment([a, b]) => a.distance(*b),
            Self::Cuboid { half_size, .. } => 2.0 * half_size.length(),
        }
    }

    /// Whether `point` may be within `reach` (m) of the core. Never says no where it is.
    #[inline(always)]
    pub(crate) fn may_reach(&self, point: Vec3, reach: f32) -> bool {
        match self {
            Self::Point(centre) => {
                let reach = reach * ROUNDING;
                point.distance_squared(*centre) <= reach * reach
            }
            _ => self.may_reach_beyond(point, reach),
        }
    }

    fn may_reach_beyond(&self, point: Vec3, reach: f32) -> bool {
        let reach = reach * ROUNDING + self.size() * 1.0e-5;
        let square = match *self {
            Self::Point(centre) => point.distance_squared(centre),
            Self::Segment([a, b]) => {
                let (offset, along) = (point - a, b - a);
                let t = (offset.dot(along) / along.length_squared()).clamp(0.0, 1.0);
                // A segment of no length is its first end.
                let nearest = if t > 0.0 { along * t } else { Vec3::ZERO };
                offset.distance_squared(nearest)
            }
            Self::Cuboid { pose, half_size } => {
                let local = pose.rotation.inverse() * (point - Vec3::from(pose.translation));
                local.distance_squared(local.clamp(-half_size, half_size))
            }
            Self::HalfSpace { point: on, normal } => {
                let offset = point - on;
                let slack = offset.length() * 1.0e-6;
                return offset.dot(normal) <= reach + slack;
            }
        };
        square <= reach * reach
    }

    /// Whether [`may_reach`](Self::may_reach) holds for any of eight particles, in plain loops.
    #[inline(always)]
    pub(crate) fn may_reach_any(&self, view: &View, reach: f32) -> bool {
        let reach = reach * ROUNDING + self.size() * 1.0e-5;
        let mut any = false;
        match *self {
            Self::Point(centre) => {
                for l in 0..LANES {
                    let (x, y, z) = (
                        view[X + l] - centre.x,
                        view[Y + l] - centre.y,
                        view[Z + l] - centre.z,
                    );
                    any |= x * x + y * y + z * z <= reach * reach;
                }
            }
            Self::Segment([a, b]) => {
                let along = b - a;
                let square = along.length_squared();
                let inverse = if square > 0.0 { 1.0 / square } else { 0.0 };
                for l in 0..LANES {
                    let (x, y, z) = (view[X + l] - a.x, view[Y + l] - a.y, view[Z + l] - a.z);
                    let t = (x * along.x + y * along.y + z * along.z) * inverse;
                    let t = if t > 0.0 { t } else { 0.0 };
                    let t = if t < 1.0 { t } else { 1.0 };
                    let (x, y, z) = (x - along.x * t, y - along.y * t, z - along.z * t);
                    any |= x * x + y * y + z * z <= reach * reach;
                }
            }
            Self::Cuboid { pose, half_size } => {
                let centre = Vec3::from(pose.translation);
                let Mat3 {
                    x_axis,
                    y_axis,
                    z_axis,
                } = Mat3::from_quat(pose.rotation);
                for l in 0..LANES {
                    let (x, y, z) = (
                        view[X + l] - centre.x,
                        view[Y + l] - centre.y,
                        view[Z + l] - centre.z,
                    );
                    let outside = |axis: Vec3, half: f32| {
                        let beyond = (x * axis.x + y * axis.y + z * axis.z).abs() - half;
                        if beyond > 0.0 { beyond } else { 0.0 }
                    };
                    let (x, y, z) = (
                        outside(x_axis, half_size.x),
                        outside(y_axis, half_size.y),
                        outside(z_axis, half_size.z),
                    );
                    any |= x * x + y * y + z * z <= reach * reach;
                }
            }
            Self::HalfSpace { point, normal } => {
                for l in 0..LANES {
                    let (x, y, z) = (
                        view[X + l] - point.x,
                        view[Y + l] - point.y,
                        view[Z + l] - point.z,
                    );
                    let slack = (x.abs() + y.abs() + z.abs()) * 1.0e-6;
                    any |= x * normal.x + y * normal.y + z * normal.z <= reach + slack;
                }
            }
        }
        any
    }

    /// From where to where the core reaches along `axis`, times its length (m); without end on a half-space's
    /// inner side.
    pub(crate) fn interval(&self, axis: Vec3) -> (f32, f32) {
        match *self {
            Self::Point(centre) => (centre.dot(axis), centre.dot(axis)),
            Self::Segment([a, b]) => {
                let (a, b) = (a.dot(axis), b.dot(axis));
                (a.min(b), a.max(b))
            }
            Self::Cuboid { pose, half_size } => {
                let middle = Vec3::from(pose.translation).dot(axis);
                let reach = (pose.rotation.inverse() * axis).abs().dot(half_size);
                (middle - reach, middle + reach)
            }
            Self::HalfSpace { .. } => (f32::NEG_INFINITY, f32::INFINITY),
        }
    }

    /// What is in the middle of the core (m), of a half-space on its plane.
    pub fn middle(&self) -> Vec3 {
        match *self {
            Self::Point(centre) => centre,
            Self::Segment([a, b]) => a.midpoint(b),
            Self::Cuboid { pose, .. } => pose.translation.into(),
            Self::HalfSpace { point, .. } => point,
        }
    }
}

/// What is searched for, in the cloth's frame: all particles nearer to a core than a radius and their own.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// Of which it is the neighbourhood.
    pub core: Core,
    /// How far the probe reaches around its core (m), with all that it is inflated by: how far it and the cloth
    /// may move.
    pub radius: f32,
    /// Radius of each particle (m).
    pub particle_radius: f32,
}

impl Probe {
    /// A ball of `radius` around `centre` (m), for particles of a radius (m).
    pub const fn ball(centre: Vec3, radius: f32, particle_radius: f32) -> Self {
        Self {
            core: Core::Point(centre),
            radius,
            particle_radius,
        }
    }

    /// How near a particle's centre is to the core where the probe meets it (m).
    pub fn reach(&self) -> f64 {
        f64::from(self.radius) + f64::from(self.particle_radius)
    }

    /// Equation (4): whether a particle at `position` is nearer to the core than both radii together. In `f64`, so
    /// that it is the same wherever it is asked.
    pub fn meets(&self, position: Vec3) -> bool {
        self.core.distance(position) < self.reach()
    }
}
