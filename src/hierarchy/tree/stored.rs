//! Storage of a tree's bounding volumes.

use bevy::math::{
    Vec3,
    bounding::{Aabb3d, BoundingSphere},
};

use super::refit::RefitLevels;
use crate::hierarchy::{
    probe::ROUNDING,
    rule::BoundRule,
    volume::{BoundingVolume, KDop, Obb, Volume},
};

/// Growth factor of a rest radius. Finite, so that a leaf's radius, 0 times this, is always 0.
pub(crate) fn growth(stretch: f32) -> f32 {
    ((1.0 + stretch) * ROUNDING).min(f32::MAX)
}

/// The bounding volumes of one type.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bounds<V: Volume> {
    pub rule: BoundRule,
    /// For `RestShape`: growth factor of a rest radius.
    pub growth: f32,
    /// For `Paper`, those of all nodes; for `Refit`, those of stored nodes.
    pub nodes: Vec<V>,
    /// For `Refit` over a grid.
    pub refit_levels: RefitLevels<V>,
}

impl<V: Volume> Default for Bounds<V> {
    fn default() -> Self {
        Self {
            rule: BoundRule::default(),
            growth: 1.0,
            nodes: Vec::new(),
            refit_levels: RefitLevels::default(),
        }
    }
}

impl<V: Volume> Bounds<V> {
    /// Around a node's middle particle under `RestShape`.
    #[inline(always)]
    pub fn at_rest(&self, middle: Vec3, rest_radius: f32) -> V {
        V::around(middle, rest_radius * self.growth)
    }
}

/// Bounding volumes of one of the types, so that all loops over nodes are compiled for it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Volumes {
    Sphere(Bounds<BoundingSphere>),
    Aabb(Bounds<Aabb3d>),
    Obb(Bounds<Obb>),
    KDop14(Bounds<KDop<7>>),
    KDop18(Bounds<KDop<9>>),
    KDop26(Bounds<KDop<13>>),
}

impl Default for Volumes {
    fn default() -> Self {
        Self::of(BoundingVolume::Sphere)
    }
}

/// Runs the same code for any type.
macro_rules! each {
    ($volumes:expr, $bounds:ident => $code:expr) => {{
        use $crate::hierarchy::tree::Volumes;
        match $volumes {
            Volumes::Sphere($bounds) => $code,
            Volumes::Aabb($bounds) => $code,
            Volumes::Obb($bounds) => $code,
            Volumes::KDop14($bounds) => $code,
            Volumes::KDop18($bounds) => $code,
            Volumes::KDop26($bounds) => $code,
        }
    }};
}
pub(crate) use each;

impl Volumes {
    /// An empty set of a type.
    pub fn of(volume: BoundingVolume) -> Self {
        match volume {
            BoundingVolume::Sphere => Self::Sphere(Bounds::default()),
            BoundingVolume::Aabb => Self::Aabb(Bounds::default()),
            BoundingVolume::Obb => Self::Obb(Bounds::default()),
            BoundingVolume::KDop14 => Self::KDop14(Bounds::default()),
            BoundingVolume::KDop18 => Self::KDop18(Bounds::default()),
            BoundingVolume::KDop26 => Self::KDop26(Bounds::default()),
        }
    }

    /// The type.
    pub fn kind(&self) -> BoundingVolume {
        match self {
            Self::Sphere(_) => BoundingVolume::Sphere,
            Self::Aabb(_) => BoundingVolume::Aabb,
            Self::Obb(_) => BoundingVolume::Obb,
            Self::KDop14(_) => BoundingVolume::KDop14,
            Self::KDop18(_) => BoundingVolume::KDop18,
            Self::KDop26(_) => BoundingVolume::KDop26,
        }
    }
}
