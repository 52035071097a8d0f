//! The interface of all bounding volumes.

use std::fmt::Debug;

use bevy::math::Vec3;

use crate::{cloth::View, hierarchy::probe::Probe};

/// A bounding volume of a tree. It bounds the centres of particles; tests against it add their radius to the reach.
pub(crate) trait Volume: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Eight volumes, lane by lane, so that one instruction works on eight nodes.
    type Lanes: Copy + Debug + PartialEq + Send + Sync + 'static;

    /// Eight volumes that have not been computed yet.
    const UNSET: Self::Lanes;

    /// Around the ball with `radius` at `centre` (m).
    fn around(centre: Vec3, radius: f32) -> Self;

    /// Around four volumes, of which some may be the same. Those of a grid's patch come row by row.
    fn unite(children: [&Self; 4]) -> Self;

    /// Whether the volume may be within `reach` (m) of the probe's core. Never false if it is.
    fn may_reach(&self, probe: &Probe, reach: f32) -> bool;

    /// Inflated by `radius` (m): around particles including their radius.
    fn inflated(&self, radius: f32) -> Self;

    /// The corners of each of its faces, in order, for drawing. Spheres and boxes, which gizmos know, have none.
    fn faces(&self) -> Vec<Vec<Vec3>> {
        Vec::new()
    }

    /// Around four particles in each lane.
    fn of_particles(children: [&View; 4], into: &mut Self::Lanes);

    /// Around four volumes in each lane.
    fn unite_lanes(children: [&Self::Lanes; 4], into: &mut Self::Lanes);

    /// The volume of a lane.
    fn lane(lanes: &Self::Lanes, lane: usize) -> Self;

    /// Sets the volume of a lane.
    fn set_lane(lanes: &mut Self::Lanes, lane: usize, volume: Self);
}
