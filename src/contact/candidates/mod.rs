//! The particles and triangles that each collider may touch in a tick, and the results of their tests.

mod blocks;
mod guard;
mod narrow_phase;
mod saved;
mod touch;

pub(crate) use blocks::{
    Candidate, Candidates, ContactBlock, PushedParticles, Ranges, TestedFaces,
};
pub(crate) use guard::Guard;
pub use narrow_phase::{NarrowPhase, PARTICLES_FROM};
pub(crate) use saved::SavedCandidates;
pub use touch::{ContactPoint, ContactSettings, Touch};
