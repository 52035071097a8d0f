//! The listed pairs of features that may touch in a sub-step.

use super::{
    certificate::LEFT_OF_THICKNESS,
    members::{Members, NOBODY},
    motion::Motion,
    near_features::NearFeatures,
    origin::Origin,
    pair::{NearPair, VERTEX_AND_FACE},
    participant::Participant,
    patch_pair::Candidate,
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
}

impl Contacts {
    /// Lists them anew. `before` has the positions before colliders pushed.
    pub fn list(
        &mut self,
        near: &mut NearFeatures,
        cloths: &[Participant],
        motion: &Motion,
        members: &mut Members,
        before: &Origin,
    ) {
        members.last_of.fill(NOBODY);
        self.pairs.clear();
        near.has_changed = false;
        let add = |candidate: &Candidate, of: [u32; 2], near: f32| {
            let particles = candidate.particles;
            let members_of =
                particles.map_inline(|particle| members.of(particle, cloths, motion, before));
            let split = candidate.split as usize;
            let nearest = candidate.nearest;
            let [a, b] = of.map_inline(|cloth| cloths[cloth as usize].settings.friction);
            // Strands side by side are nearest at ends of edges. No vertex and face push them.
            let is_of_rope = of
                .iter()
                .any(|cloth| cloths[*cloth as usize].sheet.is_rope());
            let mut before = NOBODY;
            if split == VERTEX_AND_FACE {
                let last = &mut members.last_of[members_of[0] as usize];
                before = std::mem::replace(last, self.pairs.len() as u32);
            }
            self.pairs.push(NearPair {
                members: members_of,
                split,
                thickness: candidate.thickness,
                friction: (a * b).sqrt(),
                distance: nearest.distance,
                normal: nearest.normal,
                weights: nearest.weights,
                is_pushed: split == VERTEX_AND_FACE || is_of_rope || !nearest.is_at_border(),
                before,
                may_pass: candidate.nearest.distance
                    <= near + LEFT_OF_THICKNESS * candidate.thickness,
            });
        };
        near.contacts(motion, add);
    }

    /// Marks the faces from which a nearer face already keeps a vertex away: the nearest point is on an edge of both.
    pub fn leave_out_implied(&mut self, members: &Members, counts: &mut Counts) {
        for index in 0..self.pairs.len() {
            let pair = &self.pairs[index];
            if pair.split != VERTEX_AND_FACE || pair.weights.iter().all(|&weight| weight != 0.0) {
                continue;
            }
            let mut next = members.last_of[pair.members[0] as usize];
            let mut is_implied = false;
            while next != NOBODY && !is_implied && counts.work > 0 {
                let other = &self.pairs[next as usize];
                let is_nearer = other.distance < pair.distance
                    || (other.distance == pair.distance && (next as usize) < index);
                let has = |corner: usize| {
                    pair.weights[corner] == 0.0
                        || other.members[1..].contains(&pair.members[corner])
                };
                counts.take(1);
                is_implied = next as usize != index
                    && other.thickness >= pair.thickness
                    && is_nearer
                    && (1..4).all(has);
                next = other.before;
            }
            self.pairs[index].is_pushed &= !is_implied;
        }
        self.pairs.retain(|pair| pair.is_pushed || pair.may_pass);
    }
}
