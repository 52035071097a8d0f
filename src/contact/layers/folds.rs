//! Which neighbouring patches may touch each other: those in sharp folds.
//!
//! A [window](super::windows) is unfolded while its faces [bend little](super::flattened) from how they lie at rest: no two of its patches
//! touch, and none touches itself. Two neighbours are a pair only if all windows that have both are folded. A window is measured again once
//! any two points of its patches may have come nearer by its slack.

use bevy::math::{Vec3A, Vec4, Vec4Swizzles};

use super::{
    compare::OF_REST, flattened::Scratch, motion::Motion, near_patches::Meets,
    participant::Participant, patch_pair::PatchPair,
};
use crate::cloth::larger_or_nan;

/// Smallest slack of an unfolded window, as a fraction of the thickness or of a flat one's slack. With less, small motion would soon
/// use it up; a pair of patches has a slack of its own.
const LEAST_SLACK: f32 = 0.2;

/// Least and most that a folded window's points move before it is measured again, as fractions of the thickness.
const MEASURED_AGAIN: [f32; 2] = [0.5, 2.0];

/// The windows of all cloths.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Folds {
    /// The first window, patch of a window, and pair of neighbours of each cloth; and one more.
    firsts: Vec<[usize; 3]>,
    windows: Vec<Window>,
    /// Of each patch of each window, its middle from that of the window, and what it had used, when the window was measured (m).
    references: Vec<Vec4>,
    /// Whether two neighbours are a pair.
    are_pairs: Vec<bool>,
    has_new: bool,
    #[cfg_attr(feature = "serialize", serde(skip))]
    scratch: Scratch,
}

/// Whether a window is folded.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Window {
    is_folded: bool,
    /// Whether it was measured in this sub-step: its references are those at the end of it.
    is_new: bool,
    /// How far its points may move against each other before it is measured again (m): −∞ until it is first measured. ∞ for one of a cloth
    /// that does not touch itself, which is not folded, and for one that cannot be laid flat, which is.
    slack: f32,
}

impl Window {
    /// Measures one with its particles at these places. It has to unfold as far as it is folded before it is measured again.
    fn measured(
        cloth: &Participant,
        window: usize,
        places: &[Vec3A],
        scratch: &mut Scratch,
    ) -> Self {
        let thickness = cloth.settings.thickness;
        let (mut is_folded, mut slack) = (true, f32::INFINITY);
        if let Some(flattened) = cloth.sheet.windows().flattened(window) {
            let closest = flattened.closest;
            let least = LEAST_SLACK * thickness.min((closest - thickness).max(OF_REST * closest));
            slack = flattened.slack(flattened.unfolded(places, scratch), thickness, OF_REST);
            // Not unfolded for NaN.
            let is_unfolded = slack > least;
            is_folded = !is_unfolded;
            if is_folded {
                slack = (least - slack)
                    .clamp(MEASURED_AGAIN[0] * thickness, MEASURED_AGAIN[1] * thickness);
            }
        }
        Self {
            is_folded,
            is_new: true,
            slack,
        }
    }
}

/// Upper bound of the approach of any two points of these patches since their references (m).
#[inline]
fn used(patches: &[u32], ends: &[Vec4], references: &[Vec4]) -> f32 {
    let each = || patches.iter().map(|&patch| ends[patch as usize]);
    let middle = each().sum::<Vec4>().xyz() / patches.len() as f32;
    let used = each().zip(references).map(|(end, reference)| {
        let moved = end - middle.extend(0.0) - *reference;
        Vec3A::from_vec4(moved).length() + moved.w
    });
    // A window at NaN is measured.
    2.0 * used.fold(0.0, larger_or_nan)
}

impl Folds {
    /// Begins with windows that are not measured.
    pub fn reset(&mut self, among: &Meets<impl Fn(usize, usize) -> bool>) {
        self.firsts.clear();
        self.windows.clear();
        let mut next = [0; 3];
        for (index, cloth) in among.cloths.iter().enumerate() {
            self.firsts.push(next);
            let windows = cloth.sheet.windows();
            let touches_itself = among.of(index, index);
            let slack = if touches_itself {
                f32::NEG_INFINITY
            } else {
                f32::INFINITY
            };
            next[0] += windows.count();
            next[1] += windows.member_count();
            next[2] += windows.pair_count();
            self.windows.resize(
                next[0],
                Window {
                    is_folded: false,
                    is_new: false,
                    slack,
                },
            );
        }
        self.firsts.push(next);
        self.references.clear();
        self.references.resize(next[1], Vec4::ZERO);
        self.are_pairs.clear();
        self.are_pairs.resize(next[2], false);
    }

    /// Measures what is used from zero again.
    pub fn begin_tick(&mut self, cloths: &[Participant], motion: &Motion) {
        for (index, cloth) in cloths.iter().enumerate() {
            let [_, first_reference, _] = self.firsts[index];
            let patches = &motion.patches[motion.firsts[index][1] as usize..];
            let windows = cloth.sheet.windows();
            let all = (0..windows.count()).flat_map(|window| windows.patches_in(window).1);
            for (reference, &patch) in self.references[first_reference..].iter_mut().zip(all) {
                reference.w -= patches[patch as usize].earlier;
            }
        }
    }

    /// Ends the sub-step: what was measured in it is used up from here on.
    pub fn pass(&mut self, cloths: &[Participant], motion: &Motion) {
        if !std::mem::take(&mut self.has_new) {
            return;
        }
        for (index, cloth) in cloths.iter().enumerate() {
            let [first, first_reference, _] = self.firsts[index];
            let starts = &motion.patches[motion.firsts[index][1] as usize..];
            for window in 0..self.firsts[index + 1][0] - first {
                if !std::mem::take(&mut self.windows[first + window].is_new) {
                    continue;
                }
                let (from, patches) = cloth.sheet.windows().patches_in(window);
                let references = &mut self.references[first_reference + from..];
                let each = || patches.iter().map(|&patch| &starts[patch as usize]);
                let middle = each().map(|patch| patch.start).sum::<Vec3A>() / patches.len() as f32;
                for (reference, patch) in references.iter_mut().zip(each()) {
                    *reference = (patch.start - middle).extend(patch.used_before());
                }
            }
        }
    }

    /// Measures the windows that may be folded at the end of the sub-step, but for a `reserve` (m). Calls `found` with
    /// neighbours that become pairs. Returns the approach of any two particles before others do (m).
    pub fn renew(
        &mut self,
        cloths: &[Participant],
        motion: &Motion,
        reserve: f32,
        mut found: impl FnMut([u32; 2], usize),
    ) -> f32 {
        let mut left = f32::INFINITY;
        for (index, cloth) in cloths.iter().enumerate() {
            let [first, first_reference, _] = self.firsts[index];
            let [first_particle, first_patch, ..] = motion.firsts[index];
            let places = &motion.end[first_particle as usize..];
            let ends = &motion.ends[first_patch as usize..];
            for window in 0..self.firsts[index + 1][0] - first {
                let state = self.windows[first + window];
                if state.slack == f32::INFINITY {
                    continue;
                }
                let (from, patches) = cloth.sheet.windows().patches_in(window);
                let used = used(patches, ends, &self.references[first_reference + from..]);
                let mut free = state.slack - used;
                // Not so for NaN.
                let has_slack = free > reserve;
                if state.is_new || !has_slack {
                    let measured = Window::measured(cloth, window, places, &mut self.scratch);
                    self.windows[first + window] = measured;
                    self.has_new = true;
                    if measured.is_folded && !state.is_folded {
                        self.pair(cloth, index, window, |[a, b], pair| {
                            found([first_patch + a, first_patch + b], pair);
                        });
                    }
                    free = measured.slack;
                }
                if !self.windows[first + window].is_folded {
                    left = left.min(free);
                }
            }
        }
        left
    }

    /// Makes pairs of the neighbours that no other window keeps apart than this one, which has just folded.
    fn pair(
        &mut self,
        cloth: &Participant,
        index: usize,
        window: usize,
        mut found: impl FnMut([u32; 2], usize),
    ) {
        let [first, _, first_pair] = self.firsts[index];
        let windows = cloth.sheet.windows();
        let (_, patches) = windows.patches_in(window);
        for (at, &a) in patches.iter().enumerate() {
            for &b in &patches[at..] {
                let Some(pair) = windows.pair_of([a, b]) else {
                    continue;
                };
                let is_folded = |of: &u32| self.windows[first + *of as usize].is_folded;
                let is_pair = &mut self.are_pairs[first_pair + pair];
                if !*is_pair && windows.with_pair(pair).iter().all(is_folded) {
                    *is_pair = true;
                    found([a, b], first_pair + pair);
                }
            }
        }
    }

    /// Whether two patches are neighbours that cannot touch.
    #[inline]
    pub fn keep_apart(&self, cloths: &[Participant], motion: &Motion, pair: &PatchPair) -> bool {
        pair.neighbours.is_some_and(|neighbours| {
            let cloth = motion.patches[pair.of[0] as usize].cloth as usize;
            let [first, _, first_pair] = self.firsts[cloth];
            let of = neighbours as usize - first_pair;
            let mut windows = cloths[cloth].sheet.windows().with_pair(of).iter();
            windows.any(|&window| !self.windows[first + window as usize].is_folded)
        })
    }

    /// Forgets a pair of neighbours.
    pub fn forget(&mut self, pair: &PatchPair) {
        if let Some(neighbours) = pair.neighbours {
            self.are_pairs[neighbours as usize] = false;
        }
    }
}
