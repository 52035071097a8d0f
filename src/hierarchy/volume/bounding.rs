//! What every kind of bounding volume can do.

use std::fmt::Debug;

use bevy::math::{DVec3, Vec3};

use crate::{
    cloth::{LANES, View},
    hierarchy::Probe,
};

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

    /// Grown by `radius` (m): around the whole of particles of that radius.
    fn inflated(&self, radius: f32) -> Self;

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
pub(super) type Lane = [f32; LANES];
