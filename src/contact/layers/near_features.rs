//! Pairs of features of near patches, and how far patches may move before others can touch.
//!
//! ```text
//!   distance of two features when compared          slack of a pair of patches:
//!   ├──── thickness ────┤──── apart ────►            the least `apart` of all features that were not listed
//!        they touch           │
//!                             used: what the patches have moved towards each other since, at most
//! ```
//!
//! Features touch only once `used > apart`. Patches are looked at again once `used > until`, at the beginning of the
//! sub-step in which that happens: up to there, nothing has touched that was not a contact, or kept apart by others. Then those of
//! their listed features are measured that may touch, or all are compared if the slack is used up.

use super::{
    compare::{Comparison, compare, cross},
    folds::Folds,
    joined::Joined,
    motion::Motion,
    near_patches::{Meets, PatchBoxes},
    participant::Participant,
    patch_pair::{Candidate, PatchPair, Place, measure},
    work::{Counts, FEATURES_LEFT_OUT, MOST_LISTED, WORK_OF_MEASURING},
};
use crate::cloth::MapInline;

/// Rest of that clearance, as a fraction, from which on contacts are measured together with others.
const SOON: f32 = 0.5;

/// The pairs of patches, and the features of those that are near each other.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct NearFeatures {
    folds: Folds,
    /// The particles that are sewn together.
    pub joined: Joined,
    pairs: Vec<PatchPair>,
    candidates: Vec<Candidate>,
    /// Number of candidates that belong to pairs of patches.
    listed: usize,
    #[cfg_attr(feature = "serialize", serde(skip))]
    due: Vec<u32>,
    #[cfg_attr(feature = "serialize", serde(skip))]
    soon: Vec<u32>,
    #[cfg_attr(feature = "serialize", serde(skip))]
    spare: Vec<Candidate>,
    #[cfg_attr(feature = "serialize", serde(skip))]
    comparison: Comparison,
    /// Whether the contacts have changed.
    pub has_changed: bool,
    /// Whether this is the first look at cloths that may be inside each other.
    pub begins: bool,
    /// Pairs of patches that were inside each other as all pairs were cleared, in order.
    #[cfg_attr(feature = "serialize", serde(skip))]
    were_tangled: Vec<[u32; 2]>,
}

impl NearFeatures {
    pub fn clear(&mut self) {
        self.pairs.clear();
        self.candidates.clear();
        self.listed = 0;
        self.has_changed = true;
    }

    /// Clears all, to look at the same patches anew. If they `begin`, any may be inside each other, otherwise those that
    /// still were.
    pub fn restart(&mut self, begins: bool, among: &Meets<impl Fn(usize, usize) -> bool>) {
        self.folds.reset(among);
        self.begins = begins;
        self.were_tangled.clear();
        if !begins {
            let tangled = self.pairs.iter().filter(|pair| pair.is_tangled);
            self.were_tangled
                .extend(tangled.map(|pair| in_order(pair.of)));
            self.were_tangled.sort_unstable();
        }
        self.clear();
    }

    /// Number of pairs of features that may touch.
    pub fn len(&self) -> usize {
        self.listed
    }

    /// The share of the patches that began inside others, and still are (0 to 1).
    pub fn tangled_share(&mut self, patches: usize) -> f32 {
        let tangled = self.pairs.iter().filter(|pair| pair.is_tangled);
        self.soon.clear();
        self.soon.extend(tangled.flat_map(|pair| pair.of));
        self.soon.sort_unstable();
        self.soon.dedup();
        self.soon.len() as f32 / patches.max(1) as f32
    }

    /// All pairs of features that may touch.
    pub fn all(&self) -> impl Iterator<Item = &Candidate> {
        let each = self.pairs.iter();
        each.flat_map(|pair| &self.candidates[pair.candidates()])
    }

    /// Each contact, by its place among all listed features, and the two cloths.
    pub fn contacts(&self, motion: &Motion) -> impl Iterator<Item = (u32, [u32; 2])> {
        self.pairs.iter().flat_map(|pair| {
            let cloths = pair
                .of
                .map_inline(|patch| motion.patches[patch as usize].cloth);
            (pair.first..pair.first + pair.contacts).map(move |index| (index, cloths))
        })
    }

    /// All pairs of features that may touch, also those that others keep apart.
    #[cfg(test)]
    pub fn near(&self) -> impl Iterator<Item = &Candidate> {
        let apart = self.pairs.iter().filter(|pair| !pair.is_tangled);
        apart.flat_map(|pair| {
            let listed = self.candidates[pair.candidates()].iter();
            listed.filter(|candidate| candidate.apart <= pair.near)
        })
    }

    /// Two listed features.
    #[inline]
    pub fn candidate(&self, index: u32) -> &Candidate {
        &self.candidates[index as usize]
    }

    /// Adds neighbours that have folded. If any patch `has_left` its box, drops the pairs whose boxes are apart, and adds
    /// those whose boxes have begun to overlap. Returns the approach of any two particles before others fold (m).
    pub fn renew(
        &mut self,
        boxes: &mut PatchBoxes,
        has_left: bool,
        among: &Meets<impl Fn(usize, usize) -> bool>,
        motion: &Motion,
        reserve: f32,
        work: &mut usize,
    ) -> f32 {
        let Self {
            pairs,
            folds,
            were_tangled,
            ..
        } = self;
        let mut found = |of: [u32; 2], neighbours: Option<u32>| {
            let is_tangled = were_tangled.binary_search(&in_order(of)).is_ok();
            pairs.push(PatchPair::new(of, neighbours, is_tangled));
        };
        let unfolded = folds.renew(among.cloths, motion, reserve, |of, neighbours| {
            found(of, Some(neighbours as u32));
        });
        if has_left {
            boxes.search(among, motion, work, |of| found(of, None));
            // Neighbours stay while they are folded: only a fold makes them a pair.
            self.retain(|_, pair| pair.neighbours.is_some() || boxes.overlap(pair.of));
        }
        self.were_tangled.clear();
        unfolded
    }

    /// Drops all pairs of patches but these.
    fn retain(&mut self, mut is_kept: impl FnMut(&mut Folds, &PatchPair) -> bool) {
        let Self {
            pairs,
            folds,
            listed,
            has_changed,
            ..
        } = self;
        pairs.retain(|pair| {
            let is_kept = is_kept(folds, pair);
            if !is_kept {
                *listed -= pair.count as usize;
                *has_changed |= pair.has_contacts();
            }
            is_kept
        });
    }

    /// Measures what is used from zero again: sums of years would round.
    pub fn begin_tick(&mut self, cloths: &[Participant], motion: &mut Motion) {
        self.folds.begin_tick(cloths, motion);
        for pair in &mut self.pairs {
            for patch in pair.of {
                pair.since -= motion.patches[patch as usize].earlier;
            }
        }
        for patch in &mut motion.patches {
            patch.earlier = 0.0;
        }
    }

    /// Ends the sub-step, or the first look.
    pub fn pass(&mut self, cloths: &[Participant], motion: &Motion) {
        self.begins = false;
        self.folds.pass(cloths, motion);
    }

    /// Looks at the patches that have used up what they may, but for a `reserve` (m). Returns the approach of any two
    /// particles before others have (m); `None` if there was too much work.
    pub fn look(
        &mut self,
        cloths: &[Participant],
        motion: &Motion,
        reserve: f32,
        counts: &mut Counts,
    ) -> Option<f32> {
        let mut left = self.find_due(motion, reserve);
        let due = std::mem::take(&mut self.due);
        if !due.is_empty() {
            self.comparison.clear(motion);
        }
        let mut are_apart = false;
        for &index in &due {
            let pair = &mut self.pairs[index as usize];
            let had_contacts = pair.has_contacts();
            if self.folds.keep_apart(cloths, motion, pair) {
                are_apart = true;
                continue;
            }
            let used_before = pair.used_at_start(motion);
            let slack = pair.slack - used_before;
            let place = Place::of(pair, cloths, motion, reserve);
            let near = if slack > place.used + reserve {
                pair.slack = slack;
                counts.take(WORK_OF_MEASURING * pair.count as usize);
                let candidates = &mut self.candidates[pair.candidates()];
                measure(pair, candidates, motion, &place, used_before)
            } else {
                counts.compared += 1;
                self.listed -= pair.count as usize;
                let first = self.candidates.len();
                pair.first = first as u32;
                compare(
                    pair,
                    cloths,
                    motion,
                    &self.joined,
                    &place,
                    &mut self.candidates,
                    &mut self.comparison,
                    &mut counts.work,
                );
                pair.count = (self.candidates.len() - first) as u32;
                self.listed += pair.count as usize;
                let candidates = &mut self.candidates[first..];
                counts.take(candidates.len());
                let near = measure(pair, candidates, motion, &place, 0.0);
                pair.is_tangled |= self.begins && pair.has_tangled(&self.candidates[first..]);
                near
            };
            counts.take(near * near / FEATURES_LEFT_OUT);
            if pair.is_tangled || self.begins {
                let cross = cross(pair, cloths, motion, &self.joined, &mut counts.work);
                if pair.is_tangled || cross {
                    pair.leave_alone(cross || near > 0, &place);
                }
            }
            self.has_changed |= had_contacts || pair.has_contacts();
            left = left.min(pair.until - place.used);
            if self.listed > MOST_LISTED * motion.end.len() {
                counts.work = 0;
            }
            if counts.work == 0 {
                break;
            }
        }
        self.due = due;
        if are_apart {
            self.drop_unfolded(cloths, motion);
        }
        if self.candidates.len() > 2 * self.listed + 64 {
            self.compact();
        }
        (counts.work > 0).then_some(left)
    }

    /// Drops neighbours that cannot touch any more.
    fn drop_unfolded(&mut self, cloths: &[Participant], motion: &Motion) {
        self.retain(|folds, pair| {
            let is_apart = folds.keep_apart(cloths, motion, pair);
            if is_apart {
                folds.forget(pair);
            }
            !is_apart
        });
    }

    /// Finds the patches that have used up what they may, but for a `reserve` (m). Returns the least that others may
    /// still use (m).
    fn find_due(&mut self, motion: &Motion, reserve: f32) -> f32 {
        self.due.clear();
        self.soon.clear();
        let (mut left, mut soon) = (f32::INFINITY, f32::INFINITY);
        let mut is_contact_due = false;
        for (index, pair) in self.pairs.iter().enumerate() {
            let until = pair.until - pair.used(motion);
            if until < reserve {
                self.due.push(index as u32);
                is_contact_due |= pair.has_contacts();
            } else if pair.has_contacts() && until < SOON * pair.near {
                self.soon.push(index as u32);
                soon = soon.min(until);
            } else {
                left = left.min(until);
            }
        }
        // One new list of contacts serves all that would soon ask for one.
        if is_contact_due {
            self.due.append(&mut self.soon);
        } else {
            left = left.min(soon);
        }
        left
    }

    /// Removes the candidates of earlier comparisons.
    fn compact(&mut self) {
        self.spare.clear();
        for pair in &mut self.pairs {
            let first = self.spare.len();
            self.spare
                .extend_from_slice(&self.candidates[pair.candidates()]);
            pair.first = first as u32;
        }
        std::mem::swap(&mut self.spare, &mut self.candidates);
    }
}

fn in_order([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
