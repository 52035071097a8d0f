//! Validation of particles that were read from a file.

use super::{ClothParticles, DEFAULT_SUBSTEP};
use crate::cloth::{
    lanes::{LANES, Layout, W},
    limits::MAX_PARTICLES,
};

impl ClothParticles {
    /// Whether the stored arrays fit the numbers of columns and rows.
    pub(crate) fn is_valid(&self) -> bool {
        let is_laid_out = self.layout.is_valid() && self.layout.len() <= MAX_PARTICLES;
        let blocks = self.blocks.len();
        let is_past = self.past.blocks.is_empty() || self.past.blocks.len() == blocks;
        let is_empty = self.layout == Layout::default();
        self.is_stepped()
            && is_past
            && (is_empty && blocks == 0 || is_laid_out && blocks == self.layout.blocks())
    }

    /// The memory layout, or an empty one if a scene file or an inspector has written an invalid one. The particles are
    /// then rebuilt.
    pub(super) fn valid_layout(&self) -> Layout {
        let is_valid = self.layout.is_valid() && self.blocks.len() == self.layout.blocks();
        if is_valid {
            self.layout
        } else {
            Default::default()
        }
    }

    /// Replaces an invalid sub-step with the default.
    pub(crate) fn mend_substep(&mut self) {
        if !self.is_stepped() {
            self.substep = DEFAULT_SUBSTEP;
        }
    }

    pub(super) fn is_stepped(&self) -> bool {
        self.substep > 0.0 && self.substep.is_finite()
    }

    /// Whether both pin the same particles, and give the others the same masses.
    pub(crate) fn weigh_as(&self, other: &Self) -> bool {
        fn masses(of: &ClothParticles) -> impl Iterator<Item = &[f32]> {
            of.blocks.iter().map(|block| &block.view()[W..W + LANES])
        }
        self.layout == other.layout && masses(self).eq(masses(other))
    }
}
