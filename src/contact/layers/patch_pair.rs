//! Two near patches: what they have used of their distance, and their listed features.

use std::ops::Range;

use bevy::math::Vec3A;

use super::{
    certificate::LEFT_OF_THICKNESS,
    motion::Motion,
    pair::{Nearest, VERTEX_AND_FACE},
    participant::Participant,
};
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
    /// near features, whether contacts or left out (m).
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
    /// Whether they are kept a thickness apart. Otherwise others keep them apart, and they only must not pass
    /// through each other.
    pub is_pushed: bool,
    /// Whether they may pass through each other before they are measured again.
    pub may_pass: bool,
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
            is_pushed: false,
            may_pass: false,
        }
    }
}

impl Candidate {
    /// Whether a nearer face already keeps the vertex away from this one: the nearest point is on an edge of both. Of two that are
    /// equally near, the `first` does.
    #[inline]
    pub fn is_implied_by(&self, other: &Self, first: bool) -> bool {
        let [own, others] = [&self.nearest, &other.nearest];
        let is_nearer =
            others.distance < own.distance || (others.distance == own.distance && first);
        let has = |corner: usize| {
            own.weights[corner] == 0.0 || other.particles[1..].contains(&self.particles[corner])
        };
        is_nearer && other.thickness >= self.thickness && (1..4).all(has)
    }

    /// Whether they are a vertex and a face whose nearest point is on its border.
    #[inline]
    pub fn may_be_implied(&self) -> bool {
        self.is_vertex_with_face() && self.nearest.weights.contains(&0.0)
    }

    #[inline]
    pub fn is_vertex_with_face(&self) -> bool {
        self.split as usize == VERTEX_AND_FACE
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

    /// Has no contacts, unless they neither touch nor cross: then they have come apart.
    pub fn leave_alone(&mut self, touch_or_cross: bool, place: &Place) {
        self.is_tangled = touch_or_cross;
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
    /// Whether one is of a rope. Strands side by side are nearest at ends of edges, and no vertex and face push them.
    is_of_rope: bool,
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
            is_of_rope: of.iter().any(|cloth| cloth.sheet.is_rope()),
            used: pair.used(motion),
            reserve,
        }
    }
}

/// Measures the listed features of two patches that have come nearer by no more than `used_before` (m), and finds which are contacts.
/// Those that are still far stay as they are. Returns the number of those that are near.
pub(super) fn measure(
    pair: &mut PatchPair,
    candidates: &mut [Candidate],
    motion: &Motion,
    place: &Place,
    used_before: f32,
) -> usize {
    pair.near = place.used + FRESH * place.thickness;
    pair.until = pair.slack;
    let mut near = 0;
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
        pair.until = pair.until.min(candidate.apart.max(pair.near));
        if candidate.apart <= pair.near {
            let Nearest { distance, .. } = candidate.nearest;
            candidate.may_pass = distance <= pair.near + LEFT_OF_THICKNESS * candidate.thickness;
            candidate.is_pushed = candidate.is_vertex_with_face()
                || place.is_of_rope
                || !candidate.nearest.is_at_border();
            candidates.swap(index, near);
            near += 1;
        }
    }
    leave_out(pair, &mut candidates[..near]);
    near
}

/// Leaves out of near features what other contacts keep apart, and what is not pushed and cannot pass.
fn leave_out(pair: &mut PatchPair, near: &mut [Candidate]) {
    for index in 0..near.len() {
        let candidate = &near[index];
        let mut others = near.iter().enumerate();
        let is_implied = candidate.may_be_implied()
            && others.any(|(at, other)| {
                at != index
                    && other.split == candidate.split
                    && other.particles[0] == candidate.particles[0]
                    && candidate.is_implied_by(other, at < index)
            });
        near[index].is_pushed &= !is_implied;
    }
    pair.contacts = 0;
    for index in 0..near.len() {
        if near[index].is_pushed || near[index].may_pass {
            near.swap(index, pair.contacts as usize);
            pair.contacts += 1;
        }
    }
}
