//! The particles and triangles that each collider may touch in a tick, and the results of their tests.

mod blocks;
mod guard;
mod kept;
mod narrow_phase;
mod touch;

pub(crate) use blocks::{Candidate, Candidates, ContactBlock, Ranges};
pub(crate) use guard::Guard;
pub(crate) use kept::Kept;
pub use narrow_phase::{NarrowPhase, PARTICLES_FROM};
pub use touch::{ContactPoint, ContactSettings, Touch};
