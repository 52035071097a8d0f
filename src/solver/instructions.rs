//! Which instructions the arithmetic is compiled to, chosen as the program runs.

use multiversion::multiversion;

use super::{
    list::ListSweep,
    wave::{GridSweep, Longest, Motion, Span},
};
use crate::cloth::Block;

/// Which instructions a sub-step may use. The results are the same to the last bit.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub enum Instructions {
    /// The widest that the machine has: on x86-64 AVX2, found out as the program runs.
    #[default]
    Widest,
    /// What every machine of the architecture has: on x86-64 SSE2.
    Baseline,
}

impl Instructions {
    #[inline]
    pub(super) fn wave(
        self,
        sweep: &GridSweep,
        blocks: &mut [Block],
        first: usize,
        span: &Span,
        motion: Motion,
        longest: &mut Longest,
    ) {
        match self {
            Self::Widest => wave_widest(sweep, blocks, first, span, motion, longest),
            Self::Baseline => sweep.wave(blocks, first, span, motion, longest),
        }
    }

    #[inline]
    pub(super) fn list(self, sweep: &ListSweep, blocks: &mut [Block], motion: Motion) {
        match self {
            Self::Widest => list_widest(sweep, blocks, motion),
            Self::Baseline => sweep.substep(blocks, motion),
        }
    }

    #[inline]
    pub(super) fn measure(self, sweep: &GridSweep, blocks: &[Block]) -> Longest {
        match self {
            Self::Widest => measure_widest(sweep, blocks),
            Self::Baseline => sweep.measure(blocks),
        }
    }
}

#[multiversion(targets("x86_64+avx+avx2"))]
fn measure_widest(sweep: &GridSweep, blocks: &[Block]) -> Longest {
    sweep.measure(blocks)
}

#[multiversion(targets("x86_64+avx+avx2"))]
fn wave_widest(
    sweep: &GridSweep,
    blocks: &mut [Block],
    first: usize,
    span: &Span,
    motion: Motion,
    longest: &mut Longest,
) {
    sweep.wave(blocks, first, span, motion, longest);
}

#[multiversion(targets("x86_64+avx+avx2"))]
fn list_widest(sweep: &ListSweep, blocks: &mut [Block], motion: Motion) {
    sweep.substep(blocks, motion);
}
