//! State kept across a repeated search within a tick.

use super::{
    blocks::Candidates,
    touch::{ContactPoint, Touch},
};
use crate::contact::friction::FrictionBudget;

/// State of the candidates, by the IDs of their colliders.
#[derive(Debug, Default, Clone)]
pub(crate) struct SavedCandidates {
    points: Vec<(usize, ContactPoint)>,
    /// Also by the cloth's blocks.
    budgets: Vec<(usize, u32, FrictionBudget)>,
}

impl SavedCandidates {
    /// Saves the results so far.
    pub fn take(&mut self, touches: &[Touch], candidates: &Candidates) {
        self.points.clear();
        self.budgets.clear();
        for touch in touches {
            let id = touch.id;
            for candidate in &candidates.all[touch.of.candidates.clone()] {
                let depth = candidates.depth_of(candidate);
                if depth > f32::NEG_INFINITY {
                    let particle = candidate.particle;
                    self.points.push((id, ContactPoint { particle, depth }));
                }
            }
            let blocks = &candidates.blocks[touch.of.blocks.clone()];
            let budgets = &candidates.budgets[touch.of.budgets.clone()];
            for (contact, held) in blocks.iter().zip(budgets) {
                if held.is_active {
                    self.budgets.push((id, contact.block, *held));
                }
            }
        }
    }

    /// The tested particles of a collider: they stay candidates, so that no contact is forgotten.
    pub fn particles(&self, id: usize) -> impl Iterator<Item = u32> + '_ {
        // In the order of the touches' IDs.
        let first = self.points.partition_point(|(known, _)| *known < id);
        self.points[first..]
            .iter()
            .take_while(move |(known, _)| *known == id)
            .map(|(_, point)| point.particle)
    }

    /// Restores the state of candidates that were found again.
    pub fn give_back(&self, touches: &[Touch], candidates: &mut Candidates) {
        let of = |id: usize| {
            let at = touches.binary_search_by_key(&id, |touch| touch.id);
            at.ok().map(|at| &touches[at].of)
        };
        for &(id, point) in &self.points {
            let Some(of) = of(id) else { continue };
            let all = &candidates.all[of.candidates.clone()];
            if let Ok(at) = all.binary_search_by_key(&point.particle, |known| known.particle) {
                let (block, lane) = all[at].lane();
                candidates.blocks[block].depth[lane] = point.depth;
            }
        }
        for &(id, block, held) in &self.budgets {
            let Some(of) = of(id) else { continue };
            let blocks = &candidates.blocks[of.blocks.clone()];
            if let Ok(at) = blocks.binary_search_by_key(&block, |contact| contact.block)
                && let Some(to) = candidates.budgets[of.budgets.clone()].get_mut(at)
            {
                *to = held;
            }
        }
    }
}
