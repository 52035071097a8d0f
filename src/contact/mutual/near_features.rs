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
//! sub-step in which that happens: up to there, nothing has touched that was not a contact. Then their listed features
//! are measured, or all are compared if the slack is used up.

use std::ops::Range;

use bevy::math::Vec3A;

use super::{
    Counts, MOST_LISTED,
    compare::compare,
    motion::Motion,
    near_patches::{Meets, Rooms},
    pair::Nearest,
    participant::Participant,
};

/// Room for motion, as a fraction of the thickness, in which the nearest points of contacts are not found again.
const FRESH: f32 = 0.12;

/// Rest of that room, as a fraction, from which on contacts are measured together with others.
const SOON: f32 = 0.5;

/// Distance of features that begin inside each other, and approach after which they are measured again, as fractions of
/// the thickness.
const INSIDE: f32 = 0.01;
const LEFT_ALONE: f32 = 0.25;

/// Two patches whose boxes overlap.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PatchPair {
    pub of: [u32; 2],
    /// The vector between them, and what they had used, when they were last looked at (m).
    between: Vec3A,
    since: f32,
    /// What they may use before features that are not listed can touch (m).
    pub slack: f32,
    /// What they may use before their features are measured again, and the largest `apart` of contacts (m).
    until: f32,
    near: f32,
    /// The listed features.
    first: u32,
    count: u32,
    /// The number of these that are contacts: the first ones.
    contacts: u32,
    /// Whether they began inside each other: they are left alone until they are apart.
    is_tangled: bool,
}

/// Two features that may touch.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Candidate {
    pub particles: [u32; 4],
    pub split: u32,
    pub thickness: f32,
    /// Their nearest points when they were last measured, and the distance less the thickness (m).
    pub nearest: Nearest,
    pub apart: f32,
}

/// The pairs of patches, and the features of those that are near each other.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct NearFeatures {
    pairs: Vec<PatchPair>,
    candidates: Vec<Candidate>,
    /// Number of candidates that belong to pairs of patches.
    listed: usize,
    due: Vec<u32>,
    soon: Vec<u32>,
    #[cfg_attr(feature = "serialize", serde(skip))]
    spare: Vec<Candidate>,
    /// Whether the contacts have changed.
    pub has_changed: bool,
    /// Whether this is the first look at cloths that may be inside each other.
    pub begins: bool,
}

impl PatchPair {
    fn new(of: [u32; 2]) -> Self {
        Self {
            of,
            between: Vec3A::ZERO,
            since: 0.0,
            slack: f32::NEG_INFINITY,
            until: f32::NEG_INFINITY,
            near: 0.0,
            first: 0,
            count: 0,
            contacts: 0,
            is_tangled: false,
        }
    }

    fn has_contacts(&self) -> bool {
        self.contacts > 0
    }

    fn candidates(&self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    /// Starts anew at the end of the sub-step, at which all their features are `apart` (m).
    fn stay_unfolded(&mut self, apart: f32, motion: &Motion) {
        let [a, b] = self.of.map(|patch| &motion.patches[patch as usize]);
        self.between = a.end - b.end;
        self.since = a.used_to_end() + b.used_to_end();
        (self.slack, self.until) = (apart, apart);
        (self.count, self.contacts) = (0, 0);
    }

    /// Whether they are inside each other, as they may begin.
    fn has_tangled(&self, candidates: &[Candidate]) -> bool {
        let is_inside = |of: &Candidate| of.nearest.distance < INSIDE * of.thickness;
        candidates.iter().any(is_inside)
    }

    /// Has no contacts, unless they have come apart.
    fn leave_alone(&mut self, place: &Place) {
        self.is_tangled = self.has_contacts();
        if self.is_tangled {
            self.contacts = 0;
            self.until = self.slack.min(place.used + LEFT_ALONE * place.thickness);
        }
    }

    /// Upper bound of their approach since they were last looked at (m).
    fn used(&self, motion: &Motion) -> f32 {
        let [a, b] = self.of.map(|patch| &motion.patches[patch as usize]);
        (a.end - b.end - self.between).length() + a.used() + b.used() - self.since
    }

    /// The same, up to the beginning of the sub-step.
    fn used_at_start(&self, motion: &Motion) -> f32 {
        let [a, b] = self.of.map(|patch| &motion.patches[patch as usize]);
        (a.start - b.start - self.between).length() + a.used_at_start() + b.used_at_start()
            - self.since
    }
}

impl NearFeatures {
    pub fn clear(&mut self) {
        self.pairs.clear();
        self.candidates.clear();
        self.listed = 0;
        self.has_changed = true;
    }

    /// Number of pairs of features that may touch.
    pub fn len(&self) -> usize {
        self.listed
    }

    /// All pairs of features that may touch.
    pub fn all(&self) -> impl Iterator<Item = &Candidate> {
        let each = self.pairs.iter();
        each.flat_map(|pair| &self.candidates[pair.candidates()])
    }

    /// Calls `add` with each contact, the two cloths, and the approach for which it is one (m).
    pub fn contacts(&self, motion: &Motion, mut add: impl FnMut(&Candidate, [u32; 2], f32)) {
        for pair in self.pairs.iter().filter(|pair| pair.has_contacts()) {
            let cloths = pair.of.map(|patch| motion.patches[patch as usize].cloth);
            let candidates = &self.candidates[pair.candidates()];
            for candidate in &candidates[..pair.contacts as usize] {
                add(candidate, cloths, pair.near);
            }
        }
    }

    /// Drops the pairs of patches whose boxes are apart, and adds those whose boxes have begun to overlap.
    pub fn renew(
        &mut self,
        rooms: &mut Rooms,
        among: &Meets<impl Fn(usize, usize) -> bool>,
        motion: &Motion,
        work: &mut usize,
    ) {
        let (listed, has_changed) = (&mut self.listed, &mut self.has_changed);
        self.pairs.retain(|pair| {
            let is_near = rooms.overlap(pair.of);
            if !is_near {
                *listed -= pair.count as usize;
                *has_changed |= pair.has_contacts();
            }
            is_near
        });
        let pairs = &mut self.pairs;
        rooms.search(among, motion, work, |of| pairs.push(PatchPair::new(of)));
    }

    /// Measures what is used from zero again: sums of years would round.
    pub fn begin_tick(&mut self, motion: &mut Motion) {
        for pair in &mut self.pairs {
            for patch in pair.of {
                pair.since -= motion.patches[patch as usize].earlier;
            }
        }
        for patch in &mut motion.patches {
            patch.earlier = 0.0;
        }
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
        let due = std::mem::take(&mut self.due);
        for &index in &due {
            let pair = &mut self.pairs[index as usize];
            let had_contacts = pair.has_contacts();
            if let Some(apart) = unfolded_by(pair, cloths, motion)
                && apart > reserve
            {
                self.listed -= pair.count as usize;
                pair.stay_unfolded(apart, motion);
                self.has_changed |= had_contacts;
                left = left.min(apart);
                continue;
            }
            let used_before = pair.used_at_start(motion);
            let slack = pair.slack - used_before;
            let place = Place::of(pair, cloths, motion, reserve);
            if slack > place.used + reserve {
                pair.slack = slack;
                counts.work = counts.work.saturating_sub(pair.count as usize);
                let candidates = &mut self.candidates[pair.candidates()];
                measure(pair, candidates, motion, &place, used_before);
            } else {
                counts.compared += 1;
                self.listed -= pair.count as usize;
                let first = self.candidates.len();
                pair.first = first as u32;
                compare(
                    pair,
                    cloths,
                    motion,
                    &place,
                    &mut self.candidates,
                    &mut counts.work,
                );
                pair.count = (self.candidates.len() - first) as u32;
                self.listed += pair.count as usize;
                let candidates = &mut self.candidates[first..];
                counts.work = counts.work.saturating_sub(4 * candidates.len());
                measure(pair, candidates, motion, &place, 0.0);
                pair.is_tangled |= self.begins && pair.has_tangled(&self.candidates[first..]);
            }
            if pair.is_tangled {
                pair.leave_alone(&place);
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
        if self.candidates.len() > 2 * self.listed + 64 {
            self.compact();
        }
        (counts.work > 0).then_some(left)
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

/// By how much the features of two patches of a grid are farther apart than the thickness at the end of the sub-step
/// (m), from the tangents around them. It does not matter how they got there: a sheet that is unfolded has not passed
/// through itself.
fn unfolded_by(pair: &PatchPair, cloths: &[Participant], motion: &Motion) -> Option<f32> {
    let [a, b] = pair
        .of
        .map(|patch| motion.patches[patch as usize].cloth as usize);
    let [first_particle, first_patch, _] = motion.firsts[a];
    let of = pair.of.map(|patch| patch - first_patch);
    let cloth = (a == b).then(|| &cloths[a])?;
    let places = &motion.end[first_particle as usize..];
    Some(cloth.sheet.unfolded(of, places)? - cloth.settings.thickness)
}

/// Two patches that are looked at, at the beginning of the sub-step.
pub(super) struct Place {
    pub thickness: f32,
    pub spacing: f32,
    /// Upper bound of their approach in the sub-step (m).
    pub used: f32,
    /// What resting layers keep (m).
    pub reserve: f32,
}

impl Place {
    /// Takes their places for those that their motion is measured from.
    fn of(pair: &mut PatchPair, cloths: &[Participant], motion: &Motion, reserve: f32) -> Self {
        let of = pair
            .of
            .map(|patch| &cloths[motion.patches[patch as usize].cloth as usize]);
        let thickness = (of[0].settings.thickness + of[1].settings.thickness) / 2.0;
        let [a, b] = pair.of.map(|patch| &motion.patches[patch as usize]);
        pair.between = a.start - b.start;
        pair.since = a.used_before() + b.used_before();
        let spacing = of.map(|cloth| cloth.sheet.surface().spacing().shortest);
        Self {
            thickness,
            spacing: spacing[0].min(spacing[1]),
            used: pair.used(motion),
            reserve,
        }
    }
}

/// Measures the listed features of two patches that have come nearer by no more than `used_before` (m). Those that are
/// still far stay as they are.
fn measure(
    pair: &mut PatchPair,
    candidates: &mut [Candidate],
    motion: &Motion,
    place: &Place,
    used_before: f32,
) {
    pair.near = place.used + FRESH * place.thickness;
    pair.contacts = 0;
    let mut least = f32::INFINITY;
    for index in 0..candidates.len() {
        let candidate = &mut candidates[index];
        candidate.apart -= used_before;
        if candidate.apart <= pair.near {
            let places = candidate
                .particles
                .map(|particle| motion.start[particle as usize]);
            candidate.nearest = Nearest::of(candidate.split as usize, places);
            candidate.apart = candidate.nearest.distance - candidate.thickness;
        }
        if candidate.apart <= pair.near {
            candidates.swap(index, pair.contacts as usize);
            pair.contacts += 1;
        } else {
            least = least.min(candidate.apart);
        }
    }
    let until = if pair.has_contacts() {
        pair.near
    } else {
        least
    };
    pair.until = until.min(pair.slack);
}
