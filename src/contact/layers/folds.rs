//! Which neighbouring patches of grids may touch each other: those in sharp folds.
//!
//! ```text
//!   ┌───┬───┬───┬───┐
//!   │ a │ b │   │   │     a window: 2 × 2 patches
//!   ├───┼───┼───┼───┤
//!   │ c │ d │   │   │     its tangents differ little: no two of a, b, c and d touch, and none touches itself
//!   └───┴───┴───┴───┘
//! ```
//!
//! Two patches are neighbours if a window has both. They are a pair only if all windows that have both are folded. A window
//! is measured again once any two particles of the cloths may have come nearer by its slack.

use super::{motion::Motion, near_patches::Meets, participant::Participant};
use crate::cloth::MapInline;

/// Smallest slack of an unfolded window, as a fraction of the thickness or of a flat one's slack. With less, the motion of
/// all would soon use it up; a pair of patches has a slack of its own.
const LEAST: f32 = 0.5;

/// In place of the approach that a window stays unfolded for: it is folded, or is not yet measured.
const FOLDED: f32 = f32::NEG_INFINITY;
const UNKNOWN: f32 = f32::MIN;

/// The windows of all cloths.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Folds {
    /// The first window of each cloth; and one more.
    firsts: Vec<usize>,
    /// [How near](Motion::approached) particles may have come to each other before a window may be folded (m), or [`FOLDED`]; ∞ for
    /// one that does not matter.
    until: Vec<f32>,
    /// Of each patch, with which neighbours it is a pair: a bit for [each](super::windows::Windows::neighbour).
    pairs: Vec<u8>,
    /// The windows of a cloth that have just folded.
    #[cfg_attr(feature = "serialize", serde(skip))]
    folded: Vec<usize>,
}

impl Folds {
    /// Begins with windows that are not measured.
    pub fn reset(&mut self, among: &Meets<impl Fn(usize, usize) -> bool>, patches: usize) {
        self.firsts.clear();
        self.until.clear();
        for (index, cloth) in among.cloths.iter().enumerate() {
            self.firsts.push(self.until.len());
            let until = if among.of(index, index) {
                UNKNOWN
            } else {
                f32::INFINITY
            };
            let windows = self.until.len() + cloth.sheet.windows().count();
            self.until.resize(windows, until);
        }
        self.firsts.push(self.until.len());
        self.pairs.clear();
        self.pairs.resize(patches, 0);
    }

    /// Measures approaches from zero again.
    pub fn begin_tick(&mut self, approached: f32) {
        self.until.iter_mut().for_each(|until| *until -= approached);
    }

    /// Measures the windows that may be folded at the end of the sub-step, but for a `reserve` (m). Calls `found` with
    /// neighbours that become pairs. Returns the approach of any two particles before others do (m).
    pub fn renew(
        &mut self,
        cloths: &[Participant],
        motion: &Motion,
        reserve: f32,
        mut found: impl FnMut([u32; 2]),
    ) -> f32 {
        let approached = motion.approached + motion.approach;
        let mut left = f32::INFINITY;
        for (index, cloth) in cloths.iter().enumerate() {
            let [first_particle, first_patch, ..] = motion.firsts[index];
            let places = &motion.end[first_particle as usize..];
            let first = self.firsts[index];
            let thickness = cloth.settings.thickness;
            let least = LEAST * thickness.min(cloth.sheet.closest() - thickness);
            self.folded.clear();
            for window in first..self.firsts[index + 1] {
                let until = &mut self.until[window];
                if *until - approached <= reserve {
                    let unfolded = cloth.sheet.unfolded(window - first, places);
                    let slack = unfolded - thickness;
                    // False for NaN.
                    if slack > least {
                        *until = approached + slack;
                    } else if *until != FOLDED {
                        *until = FOLDED;
                        self.folded.push(window - first);
                    }
                }
                if *until != FOLDED {
                    left = left.min(*until - approached);
                }
            }
            let folded = std::mem::take(&mut self.folded);
            for &window in &folded {
                for (at, a) in cloth.sheet.windows().patches_in(window).enumerate() {
                    for b in cloth.sheet.windows().patches_in(window).skip(at) {
                        self.pair(cloth, first, [a, b], first_patch, &mut found);
                    }
                }
            }
            self.folded = folded;
        }
        left
    }

    /// Makes a pair of two neighbours of a cloth, unless they are one or cannot touch.
    fn pair(
        &mut self,
        cloth: &Participant,
        first_window: usize,
        of: [u32; 2],
        first_patch: u32,
        found: &mut impl FnMut([u32; 2]),
    ) {
        let mut windows = cloth.sheet.windows().with(of);
        let bit = 1 << cloth.sheet.windows().neighbour(of);
        let (until, pairs) = (&self.until, &mut self.pairs[(first_patch + of[0]) as usize]);
        let is_folded = |window: usize| until[first_window + window] == FOLDED;
        if *pairs & bit == 0 && windows.all(is_folded) {
            *pairs |= bit;
            found(of.map_inline(|patch| first_patch + patch));
        }
    }

    /// Whether two neighbours cannot touch.
    #[inline]
    pub fn keep_apart(&self, cloths: &[Participant], motion: &Motion, of: [u32; 2]) -> bool {
        let Some((cloth, of)) = motion.of_one_cloth(of) else {
            return false;
        };
        let first = self.firsts[cloth];
        let mut windows = cloths[cloth].sheet.windows().with(of);
        windows.any(|window| self.until[first + window] != FOLDED)
    }

    /// Forgets a pair of neighbours.
    pub fn forget(&mut self, cloths: &[Participant], motion: &Motion, pair: [u32; 2]) {
        if let Some((cloth, of)) = motion.of_one_cloth(pair) {
            self.pairs[pair[0] as usize] &= !(1 << cloths[cloth].sheet.windows().neighbour(of));
        }
    }
}
