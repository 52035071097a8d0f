//! The listed pairs of features that may touch in a sub-step.

use super::{
    members::{Members, NOBODY},
    motion::Motion,
    near_features::NearFeatures,
    origin::Origin,
    pair::NearPair,
    participant::Participant,
    work::Counts,
};
use crate::cloth::MapInline;

/// The pairs that may touch in the sub-step.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Contacts {
    pub pairs: Vec<NearPair>,
    /// Those that overlap by more than layers at rest.
    pub overlapping: Vec<u32>,
    #[cfg_attr(feature = "serialize", serde(skip))]
    near: Vec<Near>,
    /// Of each particle the last pair with it as its vertex, among the near ones.
    #[cfg_attr(feature = "serialize", serde(skip))]
    last_of: Vec<u32>,
}

/// Two features that may touch: their place among all listed ones, their cloths, and the previous ones with the same vertex.
#[derive(Debug, Clone, Copy)]
struct Near {
    candidate: u32,
    cloths: [u32; 2],
    before: u32,
}

impl Contacts {
    /// Lists them anew, but for faces from which a nearer one keeps a vertex away. `before` has the positions before
    /// colliders pushed.
    pub fn list(
        &mut self,
        near: &mut NearFeatures,
        cloths: &[Participant],
        motion: &Motion,
        members: &mut Members,
        before: &Origin,
        counts: &mut Counts,
    ) {
        near.has_changed = false;
        self.pairs.clear();
        self.near.clear();
        self.last_of.clear();
        self.last_of.resize(motion.end.len(), NOBODY);
        for (index, cloths) in near.contacts(motion) {
            let candidate = near.candidate(index);
            let mut before = NOBODY;
            if candidate.is_vertex_with_face() {
                let last = &mut self.last_of[candidate.particles[0] as usize];
                before = std::mem::replace(last, self.near.len() as u32);
            }
            self.near.push(Near {
                candidate: index,
                cloths,
                before,
            });
        }
        for (index, of) in (0..).zip(&self.near) {
            let candidate = near.candidate(of.candidate);
            let mut is_implied = false;
            if candidate.may_be_implied() {
                let mut next = self.last_of[candidate.particles[0] as usize];
                while next != NOBODY && !is_implied && counts.work > 0 {
                    let other = &self.near[next as usize];
                    counts.take(1);
                    is_implied = next != index
                        && candidate.is_implied_by(near.candidate(other.candidate), next < index);
                    next = other.before;
                }
            }
            let is_pushed = candidate.is_pushed && !is_implied;
            if !is_pushed && !candidate.may_pass {
                continue;
            }
            let particles = candidate.particles;
            let [a, b] = (of.cloths).map_inline(|cloth| cloths[cloth as usize].settings.friction);
            self.pairs.push(NearPair {
                members: particles
                    .map_inline(|particle| members.of(particle, cloths, motion, before)),
                split: candidate.split as usize,
                thickness: candidate.thickness,
                friction: (a * b).sqrt(),
                nearest: candidate.nearest,
                is_pushed,
            });
        }
    }
}
