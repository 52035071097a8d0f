//! Bounding volumes: what each node of a tree may be wrapped in.

mod aabb;
mod kdop;
mod obb;
mod slabs;
mod sphere;
#[cfg(test)]
mod tests;

use std::fmt::Debug;

use bevy::{
    math::{
        DVec3, Vec3,
        bounding::{Aabb3d, BoundingSphere},
    },
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::Probe;
use crate::cloth::{LANES, View};

pub use kdop::KDop;
pub use obb::Obb;

/// A kind of bounding volume.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
pub enum BoundingVolume {
    /// A sphere.
    #[default]
    Sphere,
    /// A box along the axes of the cloth's frame.
    Aabb,
    /// A box along axes of its own.
    Obb,
    /// Between seven pairs of parallel planes: a box without its corners.
    KDop14,
    /// Between nine pairs: a box without its edges.
    KDop18,
    /// Between thirteen pairs: a box without either.
    KDop26,
}

impl BoundingVolume {
    /// The volumes with their names, for menus.
    pub const ALL: [(&str, Self); 6] = [
        ("spheres", Self::Sphere),
        ("AABBs", Self::Aabb),
        ("OBBs", Self::Obb),
        ("14-DOPs", Self::KDop14),
        ("18-DOPs", Self::KDop18),
        ("26-DOPs", Self::KDop26),
    ];

    /// Its name, in the plural.
    pub fn name(self) -> &'static str {
        let is_it = |(_, each): &&(&str, Self)| *each == self;
        Self::ALL.iter().find(is_it).map_or("", |(name, _)| name)
    }
}

/// The bounding volume of a node, around the whole of its particles.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(opaque)]
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

/// What the tree asks of a bounding volume. It bounds the centres of particles; their radius is in the reach of
/// whatever is tested against it.
pub(crate) trait Volume: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Eight of them, lane by lane, so that one instruction works on eight nodes.
    type Lanes: Copy + Debug + PartialEq + Send + Sync + 'static;

    /// Eight that have not been computed yet.
    const UNSET: Self::Lanes;

    /// Around the ball of `radius` around `centre` (m).
    fn around(centre: Vec3, radius: f32) -> Self;

    /// Around four, of which some may be the same. Of a patch of a grid they come row by row.
    fn unite(children: [&Self; 4]) -> Self;

    /// Whether the volume may be within `reach` (m) of the probe's core. Never says no where it is.
    fn may_reach(&self, probe: &Probe, reach: f32) -> bool;

    /// Whether a ball around `centre` (m) is inside, in `f64`, up to the rounding of lengths of `scale` (m).
    fn holds(&self, centre: DVec3, radius: f64) -> bool;

    /// Whether another volume is inside, up to rounding.
    fn holds_volume(&self, other: &Self) -> bool;

    /// The volume around the whole of particles of a radius (m), for the eye.
    fn drawn(&self, particle_radius: f32) -> NodeVolume;

    /// Around four particles in each lane.
    fn of_particles(children: [&View; 4], into: &mut Self::Lanes);

    /// Around four in each lane.
    fn unite_lanes(children: [&Self::Lanes; 4], into: &mut Self::Lanes);

    /// The one in a lane.
    fn lane(lanes: &Self::Lanes, lane: usize) -> Self;

    /// Puts one into a lane.
    fn set_lane(lanes: &mut Self::Lanes, lane: usize, volume: Self);
}

/// A number for each of eight nodes.
type Lane = [f32; LANES];
