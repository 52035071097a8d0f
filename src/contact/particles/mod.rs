//! The narrow phase by particles, each a ball: against analytic shapes, and against the planes of all others.

mod depth;
mod lanes;
mod near;
mod near_edges;
mod particle;
mod planes;

pub use depth::deepest_penetration;
pub(crate) use lanes::{LaneMotion, Sums};
#[cfg(test)]
pub(crate) use lanes::{
    push_cuboid, push_cuboid_baseline, push_half_space, push_half_space_baseline, push_round,
    push_round_baseline,
};
#[cfg(test)]
pub(crate) use near::{Cuboid, HalfSpace, Round};
pub(crate) use near_edges::ParticlesNearEdges;
pub(crate) use particle::{ContactResult, lane_motion, push_particles};
pub(crate) use planes::Planes;
#[cfg(test)]
pub(crate) use planes::{Frame, find_planes, push_planes, push_planes_baseline};
