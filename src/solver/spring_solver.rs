//! The common interface of all solvers of springs.

use std::fmt;

use super::{
    kernels::{Kernels, StepScale},
    stretch::Stretch,
    tether::{Anchors, Tethers},
};
use crate::cloth::{Block, Lanes};

/// Values that are the same for all particles of a sub-step.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    pub kernels: &'a Kernels,
    pub tethers: &'a Tethers,
    pub anchors: &'a Anchors,
    /// Whether it is the first sub-step of a tick.
    pub begins: bool,
    /// Whether lengths are measured, too.
    pub measures: bool,
}

/// The results of a sub-step.
#[derive(Debug, Clone, Copy)]
pub(super) struct SolvedSubstep {
    /// The largest squared displacements (m²), lane by lane.
    pub moved: Lanes,
    /// The stretch, if it was to be measured.
    pub stretch: Option<Stretch>,
    /// Angular frequency of the fastest ripples across chains, by the tension in half of the cloth's width (rad/s). 0
    /// if it was not measured or is not known.
    pub ripple: f32,
}

/// A solver of springs and tethers, which corrects predicted particles. It is made once for its springs, and kept as
/// long as they are.
pub(super) trait SpringSolver: fmt::Debug + Send + Sync {
    /// Takes over the parameters of the coming sub-step.
    fn set_step_scale(&mut self, step_scale: StepScale);

    /// Whether it leaves so little unsolved that a motion of second order may go on from it.
    fn is_exact(&self) -> bool;

    /// How many tasks it is split into at most where some are wanted.
    fn partitions(&self, wanted: usize) -> usize;

    /// Corrects the displacements of the particles in `blocks` and moves them by them, in this many partitions.
    fn substep(
        &mut self,
        blocks: &mut [Block],
        motion: &Motion,
        partitions: usize,
    ) -> SolvedSubstep;

    /// Measures the stretch.
    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch;

    /// Calls `visit` with the ends of each spring of a mesh, and its tension T L₀/L in the last sub-step, with L₀ its length at rest (N). The springs of a grid are not
    /// visited: their stretch says it.
    fn for_each_tension(&self, _visit: &mut dyn FnMut([u32; 2], f32)) {}

    /// A copy of it.
    fn boxed(&self) -> Box<dyn SpringSolver>;
}

impl Clone for Box<dyn SpringSolver> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}
