//! What solves a cloth's springs, whichever they are.

use std::fmt;

use super::{
    Stretch,
    kernel::Kernels,
    pace::Pace,
    tether::{Anchors, Tethers},
};
use crate::cloth::{Block, Lanes};

/// What is the same for all particles of a sub-step.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    pub kernels: &'a Kernels,
    pub tethers: &'a Tethers,
    pub anchors: &'a Anchors,
    /// Whether lengths are measured, too.
    pub measures: bool,
}

/// What a sub-step ends with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Swept {
    /// The largest squared displacements (m²), lane by lane.
    pub moved: Lanes,
    /// The stretch, if it was to be measured.
    pub stretch: Option<Stretch>,
    /// The angular frequency of the fastest ripples across threads that tension makes in half of the cloth's width, if that was
    /// to be measured and is known, else 0 (rad/s).
    pub ripple: f32,
}

/// A solver of springs that are known, and of tethers, for particles where they would be without: made once for them, and for
/// as long as they stay.
pub(super) trait Sweep: fmt::Debug + Send + Sync {
    /// Takes over what the coming sub-step is.
    fn set_pace(&mut self, pace: Pace);

    /// Whether it leaves so little unsolved that a motion of second order may go on from it.
    fn is_exact(&self) -> bool;

    /// How many tasks it is split into at most where some are wanted.
    fn bands(&self, wanted: usize) -> usize;

    /// Corrects the displacements of the particles in `blocks` and moves them by them, in this many bands.
    fn substep(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) -> Swept;

    /// Measures the stretch.
    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch;

    /// A copy of it.
    fn boxed(&self) -> Box<dyn Sweep>;
}

impl Clone for Box<dyn Sweep> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}
