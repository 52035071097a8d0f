//! The bounding volume of a node, of whichever kind.

use bevy::{
    math::{
        Vec3,
        bounding::{Aabb3d, BoundingSphere},
    },
    reflect::Reflect,
};

use super::{Volume, kdop::KDop, obb::Obb};

/// The bounding volume of a node, around the whole of its particles.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(opaque)]
#[non_exhaustive]
pub enum NodeVolume {
    /// A sphere.
    Sphere(BoundingSphere),
    /// A box along the axes.
    Aabb(Aabb3d),
    /// A box along axes of its own.
    Obb(Obb),
    /// Between 7 pairs of planes.
    KDop14(KDop<7>),
    /// Between 9 pairs of planes.
    KDop18(KDop<9>),
    /// Between 13 pairs of planes.
    KDop26(KDop<13>),
}

impl From<BoundingSphere> for NodeVolume {
    fn from(volume: BoundingSphere) -> Self {
        Self::Sphere(volume)
    }
}

impl From<Aabb3d> for NodeVolume {
    fn from(volume: Aabb3d) -> Self {
        Self::Aabb(volume)
    }
}

impl From<Obb> for NodeVolume {
    fn from(volume: Obb) -> Self {
        Self::Obb(volume)
    }
}

impl From<KDop<7>> for NodeVolume {
    fn from(volume: KDop<7>) -> Self {
        Self::KDop14(volume)
    }
}

impl From<KDop<9>> for NodeVolume {
    fn from(volume: KDop<9>) -> Self {
        Self::KDop18(volume)
    }
}

impl From<KDop<13>> for NodeVolume {
    fn from(volume: KDop<13>) -> Self {
        Self::KDop26(volume)
    }
}

impl NodeVolume {
    /// Grown by `radius` (m): around the whole of particles of that radius.
    pub(in crate::hierarchy) fn inflated(&self, radius: f32) -> Self {
        match self {
            Self::Sphere(volume) => volume.inflated(radius).into(),
            Self::Aabb(volume) => volume.inflated(radius).into(),
            Self::Obb(volume) => volume.inflated(radius).into(),
            Self::KDop14(volume) => volume.inflated(radius).into(),
            Self::KDop18(volume) => volume.inflated(radius).into(),
            Self::KDop26(volume) => volume.inflated(radius).into(),
        }
    }

    /// Whether a point is inside, in `f64`, up to rounding.
    pub(in crate::hierarchy) fn holds(&self, point: Vec3) -> bool {
        let point = point.as_dvec3();
        match self {
            Self::Sphere(volume) => volume.holds(point, 0.0),
            Self::Aabb(volume) => volume.holds(point, 0.0),
            Self::Obb(volume) => volume.holds(point, 0.0),
            Self::KDop14(volume) => volume.holds(point, 0.0),
            Self::KDop18(volume) => volume.holds(point, 0.0),
            Self::KDop26(volume) => volume.holds(point, 0.0),
        }
    }

    /// Whether another one of the same kind is inside, up to rounding.
    pub(in crate::hierarchy) fn holds_volume(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Sphere(volume), Self::Sphere(other)) => volume.holds_volume(other),
            (Self::Aabb(volume), Self::Aabb(other)) => volume.holds_volume(other),
            (Self::Obb(volume), Self::Obb(other)) => volume.holds_volume(other),
            (Self::KDop14(volume), Self::KDop14(other)) => volume.holds_volume(other),
            (Self::KDop18(volume), Self::KDop18(other)) => volume.holds_volume(other),
            (Self::KDop26(volume), Self::KDop26(other)) => volume.holds_volume(other),
            _ => false,
        }
    }
}
