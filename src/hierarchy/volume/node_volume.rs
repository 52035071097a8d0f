//! The bounding volume of a node, of any type.

use bevy::{
    math::{
        Vec3,
        bounding::{Aabb3d, BoundingSphere},
    },
    reflect::Reflect,
};

use super::{bounding::Volume, kdop::KDop, obb::Obb};

/// The bounding volume of a node, around its particles including their radius.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(opaque)]
#[non_exhaustive]
pub enum NodeVolume {
    /// A sphere.
    Sphere(BoundingSphere),
    /// An axis-aligned box.
    Aabb(Aabb3d),
    /// An oriented box.
    Obb(Obb),
    /// A 14-DOP, between 7 pairs of planes.
    KDop14(KDop<7>),
    /// An 18-DOP, between 9 pairs of planes.
    KDop18(KDop<9>),
    /// A 26-DOP, between 13 pairs of planes.
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
    /// Inflated by `radius` (m): around particles including their radius.
    pub(crate) fn inflated(&self, radius: f32) -> Self {
        match self {
            Self::Sphere(volume) => volume.inflated(radius).into(),
            Self::Aabb(volume) => volume.inflated(radius).into(),
            Self::Obb(volume) => volume.inflated(radius).into(),
            Self::KDop14(volume) => volume.inflated(radius).into(),
            Self::KDop18(volume) => volume.inflated(radius).into(),
            Self::KDop26(volume) => volume.inflated(radius).into(),
        }
    }

    /// Whether it contains a point, in `f64`, up to rounding errors.
    pub(crate) fn holds(&self, point: Vec3) -> bool {
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

    /// Whether it contains another volume of the same type, up to rounding errors.
    pub(crate) fn holds_volume(&self, other: &Self) -> bool {
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
