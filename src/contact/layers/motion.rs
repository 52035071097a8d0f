//! The motion of particles and patches since they were last compared.
//!
//! ```text
//!   x = c + o + δ      c: mean of a patch's particles, o: offset at its reference, |δ| ≤ deviation
//!
//!   A ●───────────────● B      approach of any two points of A and B since a comparison
//!      c_A         c_B         ≤ |(c_A − c_B) − (c_A − c_B)₀| + used(A) + used(B)
//! ```
//!
//! `used` only grows: by the deviation from the reference, however often that is taken anew. Trembling around the
//! reference does not add up. Patches that move alike use nothing up.
//!
//! A patch is measured only for those who ask for it. They ask once the [odometer](Motion::odometer), which bounds the approach of
//! any two points, has reached a reading of theirs: in calm cloth hardly any do.

use bevy::math::{Vec3A, Vec4};

use super::{
    bounds::Bounds,
    participant::{Participant, thinnest},
};
use crate::cloth::larger;

/// Deviation of a patch from its reference, as a fraction of the smallest thickness, from which on it gets a new one.
const REFERENCE: f32 = 0.05;

/// The first sub-step's number. Patches that were measured in none have 0, those in the last one of another tick 1.
const FIRST: u32 = 2;

/// A patch at the beginning and at the end of a sub-step.
#[derive(Debug, Default, Clone, Copy)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PatchMotion {
    pub cloth: u32,
    pub start: Vec3A,
    pub end: Vec3A,
    /// Largest offset of a particle along each axis at the reference (m).
    half: Vec3A,
    /// Deviations of particles from earlier references in all, and from this one at the beginning and at the end (m).
    pub earlier: f32,
    deviation: [f32; 2],
    /// The sub-step in which it was last measured, and whether its particles were put elsewhere since.
    #[cfg_attr(feature = "serialize", serde(skip))]
    measured: u32,
    #[cfg_attr(feature = "serialize", serde(skip))]
    is_changed: bool,
}

impl PatchMotion {
    /// Upper bound of all that its particles have moved against each other (m).
    #[inline]
    pub fn used(&self) -> f32 {
        self.earlier + self.deviation[1]
    }

    /// Zero of [`used`](Self::used) for a comparison at the beginning of the sub-step (m).
    #[inline]
    pub fn used_before(&self) -> f32 {
        self.earlier - self.deviation[0]
    }

    /// Zero of [`used`](Self::used) for a measurement at the end of the sub-step (m).
    #[inline]
    pub fn used_after(&self) -> f32 {
        self.earlier - self.deviation[1]
    }

    /// Upper bound of all that its particles had moved against each other before the sub-step (m).
    #[inline]
    pub fn used_at_start(&self) -> f32 {
        self.earlier + self.deviation[0]
    }

    #[inline]
    pub fn bounds_at_start(&self) -> Bounds {
        let half = self.half + self.deviation[0];
        Bounds {
            min: self.start - half,
            max: self.start + half,
        }
    }

    #[inline]
    pub fn bounds_at_end(&self) -> Bounds {
        let half = self.half + self.deviation[1];
        Bounds {
            min: self.end - half,
            max: self.end + half,
        }
    }
}

/// The particles and patches of some cloths, one cloth after the other, in the common frame.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Motion {
    /// The first particle, patch, particle of a patch, and points of eight features of each cloth; and one more.
    pub firsts: Vec<[u32; 4]>,
    /// Positions at the beginning of the sub-step, up to which layers are apart, and at its end (m).
    pub start: Vec<Vec3A>,
    pub end: Vec<Vec3A>,
    /// As they were last [measured](Self::measure).
    pub patches: Vec<PatchMotion>,
    /// The middle of each patch at its end, and what its particles have [used](PatchMotion::used), side by side.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub ends: Vec<Vec4>,
    /// Offsets of each patch's particles at its reference (m).
    offsets: Vec<Vec3A>,
    /// Deviation of a patch from its reference from which on it gets a new one (m).
    most_deviation: f32,
    /// The motion that all had in common, in all and in the sub-step (m).
    pub drift: Vec3A,
    pub drifted: Vec3A,
    /// The number of the sub-step in the tick, from [`FIRST`] on.
    substep: u32,
    /// Upper bounds of the approach of any two points in earlier sub-steps of the tick, and in this one (m).
    approached: f32,
    approach: f32,
}

impl Motion {
    /// Begins with new cloths.
    pub fn reset(&mut self, cloths: &[Participant]) {
        self.firsts.clear();
        self.patches.clear();
        let mut next = [0; 4];
        for (index, cloth) in cloths.iter().enumerate() {
            self.firsts.push(next);
            let patches = cloth.sheet.patch_count() as u32;
            let particles = (0..patches).map(|patch| cloth.sheet.particles_of(patch).len() as u32);
            next[0] += cloth.particles.len() as u32;
            next[1] += patches;
            next[2] += particles.sum::<u32>();
            next[3] += cloth.sheet.group_count();
            self.patches.resize(
                next[1] as usize,
                PatchMotion {
                    cloth: index as u32,
                    ..PatchMotion::default()
                },
            );
        }
        self.firsts.push(next);
        self.ends.clear();
        self.ends.resize(self.patches.len(), Vec4::ZERO);
        // The first measurement replaces it.
        self.offsets.clear();
        self.offsets.resize(next[2] as usize, Vec3A::ZERO);
        self.read_places(cloths);
        self.start.clone_from(&self.end);
        (self.drift, self.drifted) = (Vec3A::ZERO, Vec3A::ZERO);
        (self.substep, self.approached, self.approach) = (FIRST, 0.0, 0.0);
        self.most_deviation = REFERENCE * thinnest(cloths);
    }

    /// Begins a tick with the odometer and what patches have used at 0.
    pub fn reset_odometer(&mut self) {
        for patch in &mut self.patches {
            patch.earlier = 0.0;
            // Only its end may still be true.
            patch.measured = u32::from(patch.measured + 1 == self.substep);
        }
        (self.substep, self.approached, self.approach) = (FIRST, 0.0, 0.0);
    }

    /// Upper bound of the approach of any two points since the beginning of the tick (m). It only grows.
    #[inline]
    pub fn odometer(&self) -> f32 {
        self.approached + self.approach
    }

    /// Whether the numbers of particles match.
    pub fn is_of(&self, cloths: &[Participant]) -> bool {
        let each = self.firsts.windows(2).zip(cloths);
        self.firsts.len() == cloths.len() + 1
            && each
                .into_iter()
                .all(|(first, cloth)| (first[1][0] - first[0][0]) as usize == cloth.particles.len())
    }

    /// The cloth of a particle, and its index there.
    #[inline]
    pub fn cloth_of(&self, particle: u32) -> (usize, usize) {
        let cloth = self.firsts.partition_point(|first| first[0] <= particle) - 1;
        (cloth, (particle - self.firsts[cloth][0]) as usize)
    }

    fn read_places(&mut self, cloths: &[Participant]) {
        self.end.clear();
        for cloth in cloths {
            let blocks = cloth.particles.blocks();
            for run in cloth.particles.layout().runs() {
                let blocks = blocks[run.block..][..run.count].iter();
                let places = blocks.map(|block| cloth.point(block.position(run.lane)));
                self.end.extend(places.map(Vec3A::from));
            }
        }
    }

    /// Reads the particles' positions at the end of the sub-step, and finds how far they have moved, together and against each other.
    pub fn read(&mut self, cloths: &[Participant]) {
        self.read_places(cloths);
        self.most_deviation = REFERENCE * thinnest(cloths);
        let each = || self.end.iter().zip(&self.start);
        let sum = each().map(|(end, start)| *end - *start).sum::<Vec3A>();
        // One particle that is not finite leaves the others without a common motion.
        let sum = if sum.is_finite() { sum } else { Vec3A::ZERO };
        self.drifted = sum / self.end.len().max(1) as f32;
        self.drift += self.drifted;
        let squares = each().map(|(end, start)| (*end - *start - self.drifted).length_squared());
        // NaN is never the farthest.
        self.approach = 2.0 * squares.fold(0.0, |most, of| larger(of, most)).sqrt();
    }

    /// Puts a particle elsewhere at the end of the sub-step. Returns how far (m).
    #[inline]
    pub fn put(&mut self, cloths: &[Participant], particle: u32, place: Vec3A) -> f32 {
        let before = std::mem::replace(&mut self.end[particle as usize], place);
        if before == place {
            return 0.0;
        }
        let (cloth, local) = self.cloth_of(particle);
        for patch in cloths[cloth].sheet.patches_of(local) {
            self.patches[(self.firsts[cloth][1] + patch) as usize].is_changed = true;
        }
        before.distance(place)
    }

    /// Takes into account that particles were put elsewhere, by no more than this distance (m).
    pub fn note(&mut self, farthest: f32) {
        self.approach += 2.0 * farthest;
    }

    /// Measures a patch at the beginning and at the end of the sub-step, unless it is measured.
    #[inline]
    pub fn measure(&mut self, cloths: &[Participant], index: u32) {
        let patch = &self.patches[index as usize];
        if patch.measured != self.substep || patch.is_changed {
            self.measure_anew(cloths, index as usize);
        }
    }

    fn measure_anew(&mut self, cloths: &[Participant], index: usize) {
        let patch = &mut self.patches[index];
        let [first_particle, first_patch, first_offset, _] = self.firsts[patch.cloth as usize];
        let (sheet, own) = (
            &cloths[patch.cloth as usize].sheet,
            index as u32 - first_patch,
        );
        let particles = sheet.particles_of(own);
        let first = (first_offset + sheet.first_of(own)) as usize;
        let offsets = &mut self.offsets[first..first + particles.len()];
        let [starts, ends] = [&self.start, &self.end].map(|of| &of[first_particle as usize..]);
        if patch.measured != self.substep {
            let is_known = patch.measured + 1 == self.substep && !patch.is_changed;
            (patch.start, patch.deviation[0]) = if is_known {
                (patch.end, patch.deviation[1])
            } else {
                middle_and_deviation(starts, particles, offsets)
            };
            // Also for NaN.
            let is_near = patch.deviation[0] <= self.most_deviation;
            if !is_near {
                patch.half = Vec3A::ZERO;
                for (&particle, offset) in particles.iter().zip(&mut *offsets) {
                    *offset = starts[particle as usize] - patch.start;
                    patch.half = patch.half.max(offset.abs());
                }
                patch.earlier += patch.deviation[0];
                patch.deviation[0] = 0.0;
            }
            patch.measured = self.substep;
        }
        patch.is_changed = false;
        (patch.end, patch.deviation[1]) = middle_and_deviation(ends, particles, offsets);
        self.ends[index] = patch.end.extend(patch.used());
    }

    /// Ends the sub-step: the next one begins where it ended.
    pub fn pass(&mut self) {
        std::mem::swap(&mut self.start, &mut self.end);
        self.drifted = Vec3A::ZERO;
        self.approached += self.approach;
        self.approach = 0.0;
        self.substep += 1;
    }

    /// Begins a sub-step in which nothing has moved yet.
    pub fn stay(&mut self) {
        self.end.clone_from(&self.start);
    }
}

/// The middle of some particles (m), and how far one of them is at most from its offset.
#[inline]
fn middle_and_deviation(places: &[Vec3A], particles: &[u32], offsets: &[Vec3A]) -> (Vec3A, f32) {
    let each = particles.iter().map(|&particle| places[particle as usize]);
    let middle = each.clone().sum::<Vec3A>() / particles.len() as f32;
    let squares = each
        .zip(offsets)
        .map(|(place, offset)| (place - middle - *offset).length_squared());
    (middle, squares.fold(0.0, f32::max).sqrt())
}
