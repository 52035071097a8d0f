//! What solves a cloth's springs, whichever they are.

use std::fmt;

use super::{
    Stretch,
    kernel::Kernels,
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
}

/// One sweep over springs that are known, tethers: made once for them, and for as long as they stay.
pub(super) trait Sweep: fmt::Debug + Send + Sync {
    /// Takes over the length of a sub-step (s).
    fn set_substep(&mut self, substep: f32);

    /// How many tasks it is split into at most where some are wanted.
    fn bands(&self, wanted: usize) -> usize;

    /// Ends a sub-step of the particles in `blocks`, which have the displacements that they would have without springs, in this
    /// many bands.
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
