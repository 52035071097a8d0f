//! Particles that were read from a file, and put back.

use super::ClothParticles;
use crate::cloth::{Block, Lanes, Layout, MAX_PARTICLES, W};

impl ClothParticles {
    /// Whether they lie in memory as so many columns and rows do, in what somebody has read from a file.
    #[cfg_attr(
        not(feature = "serialize"),
        allow(dead_code, reason = "nothing is read")
    )]
    pub(crate) fn is_sound(&self) -> bool {
        let Layout { columns, rows, .. } = self.layout;
        let is_laid_out = columns
            .checked_mul(rows)
            .is_some_and(|count| count as usize <= MAX_PARTICLES)
            && self.layout == Layout::new(columns, rows);
        let blocks = self.blocks.len();
        let is_past = self.past.blocks.is_empty() || self.past.blocks.len() == blocks;
        let is_empty = columns == 0 && rows == 0;
        let is_stepped = self.substep > 0.0 && self.substep.is_finite();
        is_stepped
            && is_past
            && (is_empty && blocks == 0 || is_laid_out && blocks == self.layout.blocks())
    }

    /// Whether two hold the same particles still, and give the others the same masses.
    pub(crate) fn weigh_as(&self, other: &Self) -> bool {
        let masses = |block: &Block| -> Lanes {
            let view = block.view();
            std::array::from_fn(|lane| view[W + lane])
        };
        self.layout == other.layout
            && self.blocks.len() == other.blocks.len()
            && (self.blocks.iter().zip(&other.blocks))
                .all(|(own, other)| masses(own) == masses(other))
    }
}
