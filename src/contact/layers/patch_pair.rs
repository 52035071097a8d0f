//! Two near patches: what they have used of their distance, and their listed features.

use std::ops::Range;

use bevy::math::Vec3A;

use super::{motion::Motion, pair::Nearest, participant::Participant};
use crate::cloth::MapInline;

/// Room for motion, as a fraction of the thickness, in which the nearest points of contacts are not found again.
const FRESH: f32 = 0.22;

/// Distance of features that begin inside each other, and approach after which they are measured again, as fractions of
/// the thickness.
const INSIDE: f32 = 0.01;
const LEFT_ALONE: f32 = 0.25;

/// Two patches whose boxes overlap.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PatchPair {
    pub of: [u32; 2],
    /// Which neighbours they are among [all](super::folds), if they are.
    pub neighbours: Option<u32>,
    /// The vector between them, and what they had used, when they were last looked at (m).
    between: Vec3A,
    pub since: f32,
    /// How far they may approach each other before features that are not listed can touch (m).
    pub slack: f32,
    /// How far they may approach each other before their features are measured again, and the largest `apart` of
    /// contacts (m).
    pub until: f32,
    pub near: f32,
    /// The listed features.
    pub first: u32,
    pub count: u32,
    /// The number of these that are contacts: the first ones.
    pub contacts: u32,
    /// Whether they began inside each other: they are left alone until they are apart.
    pub is_tangled: bool,
}

/// Two features that may touch.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Candidate {
    pub particles: [u32; 4],
    pub split: u32,
    pub thickness: f32,
    /// Their nearest points when they were last measured. The default until they are near enough to touch.
    pub nearest: Nearest,
    /// The distance less the thickness, at least (m).
    pub apart: f32,
}

impl Candidate {
    /// Two features that are at least so far apart (m).
    #[inline]
    pub fn new(particles: [u32; 4], split: usize, thickness: f32, distance: f32) -> Self {
        Self {
            particles,
            split: split as u32,
            thickness,
            nearest: Nearest::default(),
            apart: distance - thickness,
        }
    }
}

impl PatchPair {
    #[inline]
    pub fn new(of: [u32; 2], neighbours: Option<u32>, is_tangled: bool) -> Self {
        Self {
            of,
            neighbours,
            between: Vec3A::ZERO,
            since: 0.0,
            slack: f32::NEG_INFINITY,
            until: f32::NEG_INFINITY,
            near: 0.0,
            first: 0,
            count: 0,
            contacts: 0,
            is_tangled,
        }
    }

    #[inline]
    pub fn has_contacts(&self) -> bool {
        self.contacts > 0
    }

    #[inline]
    pub fn candidates(&self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    /// Whether they are inside each other, as they may begin.
    pub fn has_tangled(&self, candidates: &[Candidate]) -> bool {
        let is_inside = |of: &Candidate| of.apart < (INSIDE - 1.0) * of.thickness;
        candidates.iter().any(is_inside)
    }

    /// Has no contacts, unless they neither touch nor `cross`: then they have come apart.
    pub fn leave_alone(&mut self, cross: bool, place: &Place) {
        self.is_tangled = cross || self.has_contacts();
        if self.is_tangled {
            self.contacts = 0;
            self.until = self.slack.min(place.used + LEFT_ALONE * place.thickness);
        }
    }

    /// Upper bound of their approach since they were last looked at (m).
    #[inline]
    pub fn used(&self, motion: &Motion) -> f32 {
        let [a, b] = self.of.map_inline(|patch| motion.ends[patch as usize]);
        (Vec3A::from_vec4(a - b) - self.between).length() + a.w + b.w - self.since
    }

    /// The same, up to the beginning of the sub-step.
    #[inline]
    pub fn used_at_start(&self, motion: &Motion) -> f32 {
        let [a, b] = self.of.map_inline(|patch| &motion.patches[patch as usize]);
        (a.start - b.start - self.between).length() + a.used_at_start() + b.used_at_start()
            - self.since
    }
}

/// Two patches that are looked at, at the beginning of the sub-step.
pub(super) struct Place {
    pub thickness: f32,
    pub spacing: f32,
    /// Upper bound of their approach in the sub-step (m).
    pub used: f32,
    /// The reserve of resting layers (m).
    pub reserve: f32,
}

impl Place {
    /// Takes their places for those that their motion is measured from.
    #[inline]
    pub fn of(pair: &mut PatchPair, cloths: &[Participant], motion: &Motion, reserve: f32) -> Self {
        let of = pair
            .of
            .map_inline(|patch| &cloths[motion.patches[patch as usize].cloth as usize]);
        let thickness = (of[0].settings.thickness + of[1].settings.thickness) / 2.0;
        let [a, b] = pair.of.map_inline(|patch| &motion.patches[patch as usize]);
        pair.between = a.start - b.start;
        pair.since = a.used_before() + b.used_before();
        let spacing = of.map_inline(|cloth| cloth.sheet.surface().spacing().shortest);
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
pub(super) fn measure(
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
        // Also for NaN.
        let is_far = candidate.apart > pair.near;
        if !is_far {
            let places = candidate
                .particles
                .map_inline(|particle| motion.start[particle as usize]);
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
