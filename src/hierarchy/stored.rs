//! What is stored of a tree's bounding volumes.

use bevy::math::{
    Vec3,
    bounding::{Aabb3d, BoundingSphere},
};

use super::{
    BoundRule, BoundingVolume, KDop, Obb, probe::ROUNDING, refit::RefitLevels, volume::Volume,
};

/// What a radius at rest grows by. Finite, so that a leaf's, 0 times this, is 0 whatever becomes of the cloth.
pub(super) fn growth(stretch: f32) -> f32 {
    ((1.0 + stretch) * ROUNDING).min(f32::MAX)
}

/// The bounding volumes of one kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bounds<V: Volume> {
    pub rule: BoundRule,
    /// Of `RestShape`: what a radius at rest grows by.
    pub growth: f32,
    /// Of `Paper` each node's; of `Refit` those of nodes that are stored one by one.
    pub nodes: Vec<V>,
    /// Of `Refit` over a grid.
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

/// One of the kinds, so that all that loops over nodes is compiled for it.
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

/// Runs the same code for whichever kind it is.
macro_rules! each {
    ($volumes:expr, $bounds:ident => $code:expr) => {{
        use $crate::hierarchy::stored::Volumes;
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
pub(super) use each;

impl Volumes {
    /// None yet, of a kind.
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

    /// Which kind it is.
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
