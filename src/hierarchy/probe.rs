//! Regions to search a tree for.

use bevy::{
    math::{DQuat, DVec3, Isometry3d, Mat3, Vec3},
    reflect::Reflect,
};

use crate::cloth::{LANES, MapInline, View, X, Y, Z};

/// Factor on lengths, so that rounding in `f32` never makes a bound too small. A bound and its test take fewer than 20
/// roundings of half an ε each; this is 84 ε.
pub(crate) const ROUNDING: f32 = 1.0 + 1.0e-5;

/// The core of a [`Probe`].
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
pub enum Core {
    /// A point: the probe is a ball.
    Point(Vec3),
    /// A segment between two points (m): the probe is a capsule.
    Segment([Vec3; 2]),
    /// A box: the probe is a rounded box.
    Cuboid {
        /// Its middle (m) and axes.
        pose: Isometry3d,
        /// Half of its side lengths along its axes (m).
        half_size: Vec3,
    },
    /// A half-space.
    HalfSpace {
        /// A point of its plane (m).
        point: Vec3,
        /// Outward normal, of length 1.
        normal: Vec3,
    },
}

impl Core {
    /// Vector from the nearest point of the core to `point` (m), in `f64`. In a half-space it points inwards, and its
    /// length is the depth.
    #[inline(always)]
    fn offset(&self, point: Vec3) -> DVec3 {
        let point = point.as_dvec3();
        match *self {
            Self::Point(centre) => point - centre.as_dvec3(),
            Self::Segment([a, b]) => {
                let (a, b) = (a.as_dvec3(), b.as_dvec3());
                let (offset, along) = (point - a, b - a);
                let t = (offset.dot(along) * along.length_squared().recip()).min(1.0);
                // A segment of zero length is its first end.
                if t > 0.0 { offset - along * t } else { offset }
            }
            Self::Cuboid { pose, half_size } => {
                let rotation =
                    DQuat::from_array(pose.rotation.to_array().map_inline(f64::from)).normalize();
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

    /// Distance of `point` from the core (m), in `f64`: 0 inside, negative inside a half-space.
    #[inline(always)]
    pub fn distance(&self, point: Vec3) -> f64 {
        let offset = self.offset(point);
        match self {
            Self::HalfSpace { normal, .. } => offset.dot(normal.as_dvec3()),
            _ => offset.length(),
        }
    }

    /// Length (m) that determines the rounding errors of a distance from this core.
    #[inline(always)]
    pub(crate) fn size(&self) -> f32 {
        match self {
            Self::Point(_) | Self::HalfSpace { .. } => 0.0,
            Self::Segment([a, b]) => a.distance(*b),
            Self::Cuboid { half_size, .. } => 2.0 * half_size.length(),
        }
    }

    /// Whether `point` may be within `reach` (m) of the core. Never false if it is.
    // Inlined, so that the compiler takes what depends on the core alone out of loops over nodes.
    #[inline(always)]
    pub(crate) fn may_reach(&self, point: Vec3, reach: f32) -> bool {
        let reach = reach * ROUNDING + self.size() * 1.0e-5;
        let square = match *self {
            Self::Point(centre) => point.distance_squared(centre),
            Self::Segment([a, b]) => {
                let (offset, along) = (point - a, b - a);
                let square = along.length_squared();
                let inverse = if square > 0.0 { 1.0 / square } else { 0.0 };
                let t = offset.dot(along) * inverse;
                // NaN, as of a segment that is too short to divide by its square, is the first end.
                let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
                offset.distance_squared(along * t)
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

    /// Whether [`may_reach`](Self::may_reach) is true for any of eight particles, in plain loops.
    #[inline(always)]
    pub(crate) fn may_reach_any(&self, view: &View, reach: f32) -> bool {
        let reach = reach * ROUNDING + self.size() * 1.0e-5;
        let mut any = false;
        match *self {
            Self::Point(c) => {
                for l in 0..LANES {
                    let (x, y, z) = (view[X + l] - c.x, view[Y + l] - c.y, view[Z + l] - c.z);
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
                let c = Vec3::from(pose.translation);
                let axes = Mat3::from_quat(pose.rotation);
                for l in 0..LANES {
                    let (x, y, z) = (view[X + l] - c.x, view[Y + l] - c.y, view[Z + l] - c.z);
                    let outside = |axis: Vec3, half: f32| {
                        let beyond = (x * axis.x + y * axis.y + z * axis.z).abs() - half;
                        if beyond > 0.0 { beyond } else { 0.0 }
                    };
                    let (x, y, z) = (
                        outside(axes.x_axis, half_size.x),
                        outside(axes.y_axis, half_size.y),
                        outside(axes.z_axis, half_size.z),
                    );
                    any |= x * x + y * y + z * z <= reach * reach;
                }
            }
            Self::HalfSpace { point: p, normal } => {
                for l in 0..LANES {
                    let (x, y, z) = (view[X + l] - p.x, view[Y + l] - p.y, view[Z + l] - p.z);
                    let slack = (x.abs() + y.abs() + z.abs()) * 1.0e-6;
                    any |= x * normal.x + y * normal.y + z * normal.z <= reach + slack;
                }
            }
        }
        any
    }

    /// The interval of the core along `axis`, times the axis' length (m); unbounded on a half-space's inner side.
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

    /// The middle of the core (m); for a half-space, its point on the plane.
    pub fn middle(&self) -> Vec3 {
        match *self {
            Self::Point(centre) => centre,
            Self::Segment([a, b]) => a.midpoint(b),
            Self::Cuboid { pose, .. } => pose.translation.into(),
            Self::HalfSpace { point, .. } => point,
        }
    }
}

/// A region to search for, in the cloth's frame: all particles whose distance from a core is less than a radius and
/// their own.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
pub struct Probe {
    /// The core.
    pub core: Core,
    /// Radius around the core (m), including the margin for the motion of the collider and of the cloth.
    pub radius: f32,
    /// Radius of each particle (m).
    pub particle_radius: f32,
}

impl Probe {
    /// A ball of `radius` around `centre` (m), for particles of `particle_radius` (m).
    pub const fn ball(centre: Vec3, radius: f32, particle_radius: f32) -> Self {
        Self {
            core: Core::Point(centre),
            radius,
            particle_radius,
        }
    }

    /// Distance between core and particle centre below which the probe meets a particle (m).
    pub fn reach(&self) -> f64 {
        f64::from(self.radius) + f64::from(self.particle_radius)
    }

    /// Equation (4): whether the distance of a particle at `position` from the core is less than the sum of both radii.
    /// In `f64`, so that all callers get the same result.
    // Inlined, as above.
    #[inline(always)]
    pub fn meets(&self, position: Vec3) -> bool {
        let reach = self.reach();
        match self.core {
            Core::HalfSpace { .. } => self.core.distance(position) < reach,
            // By squares, as a root takes longer than all the rest.
            _ => reach > 0.0 && self.core.offset(position).length_squared() < reach * reach,
        }
    }
}
