//! Particles near a shape with edges.

use super::lanes::LaneMotion;
use crate::{
    cloth::Slot,
    contact::{
        candidates::{Candidate, ContactBlock},
        colliders::ColliderSubstep,
    },
};

/// The particles near a shape with edges, at the end of a sub-step.
pub(crate) struct ParticlesNearEdges<'a> {
    pub candidates: &'a [Candidate],
    /// Their blocks; `first` is the index of the first among all.
    pub contacts: &'a mut [ContactBlock],
    pub first: usize,
    pub motion: ColliderSubstep<'a>,
    pub lanes: &'a LaneMotion,
    /// Whether some are pinned only now, so that they are not pushed.
    pub has_hidden: bool,
}

impl ParticlesNearEdges<'_> {
    /// Index of a candidate's block, and its slot in the cloth.
    pub fn place(&self, candidate: &Candidate) -> (usize, Slot) {
        let (block, lane) = candidate.lane();
        let index = block - self.first;
        let block = self.contacts[index].block as usize;
        (index, Slot { block, lane })
    }

    /// Stores the depth of a candidate (m).
    pub fn note_depth(&mut self, index: usize, lane: usize, depth: f32) {
        let known = &mut self.contacts[index].depth[lane];
        *known = known.max(depth);
    }
}
