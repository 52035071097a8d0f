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

use bevy::math::{Vec3A, Vec4};

use super::{bounds::Bounds, participant::Participant};

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
    /// Whether its particles were put elsewhere since it was measured.
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
    pub patches: Vec<PatchMotion>,
    /// The middle of each patch at its end, and what its particles have [used](PatchMotion::used), side by side.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub ends: Vec<Vec4>,
    /// Offsets of each patch's particles at its reference (m).
    offsets: Vec<Vec3A>,
    /// The patches whose particles were put elsewhere.
    #[cfg_attr(feature = "serialize", serde(skip))]
    changed: Vec<u32>,
    /// The motion that all had in common, in all and in the sub-step (m).
    pub drift: Vec3A,
    pub drifted: Vec3A,
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
        (self.drift, self.drifted) = (Vec3A::ZERO, Vec3A::ZERO);
        self.read(cloths);
        self.start.clone_from(&self.end);
        self.offsets.clear();
        self.offsets.resize(next[2] as usize, Vec3A::ZERO);
        self.measure(cloths);
        // Each patch gets a reference.
        self.pass(cloths, f32::NEG_INFINITY);
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

    /// Reads the particles' positions at the end of the sub-step.
    pub fn read(&mut self, cloths: &[Participant]) {
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

    /// Measures the motion that all have in common.
    pub fn measure_all(&mut self) {
        let each = self.end.iter().zip(&self.start);
        let sum = each.map(|(end, start)| *end - *start).sum::<Vec3A>();
        // One particle that is not finite leaves the others without a common motion.
        let sum = if sum.is_finite() { sum } else { Vec3A::ZERO };
        let drifted = sum / self.end.len().max(1) as f32;
        self.drift += drifted - self.drifted;
        self.drifted = drifted;
    }

    /// Puts a particle elsewhere at the end of the sub-step.
    #[inline]
    pub fn put(&mut self, cloths: &[Participant], particle: u32, place: Vec3A) {
        let before = std::mem::replace(&mut self.end[particle as usize], place);
        if before == place {
            return;
        }
        let (cloth, local) = self.cloth_of(particle);
        for patch in cloths[cloth].sheet.patches_of(local) {
            let patch = self.firsts[cloth][1] + patch;
            if !std::mem::replace(&mut self.patches[patch as usize].is_changed, true) {
                self.changed.push(patch);
            }
        }
    }

    /// Measures the patches whose particles were put elsewhere.
    pub fn measure_changed(&mut self, cloths: &[Participant]) {
        let changed = std::mem::take(&mut self.changed);
        for &patch in &changed {
            self.patches[patch as usize].is_changed = false;
            self.measure_patch(cloths, patch as usize);
        }
        self.changed = changed;
        self.changed.clear();
    }

    /// Measures each patch at the end of the sub-step.
    pub fn measure(&mut self, cloths: &[Participant]) {
        self.ends.resize(self.patches.len(), Vec4::ZERO);
        (0..self.patches.len()).for_each(|patch| self.measure_patch(cloths, patch));
    }

    fn measure_patch(&mut self, cloths: &[Participant], index: usize) {
        let state = &mut self.patches[index];
        let [first_particle, first_patch, first_offset, _] = self.firsts[state.cloth as usize];
        let sheet = &cloths[state.cloth as usize].sheet;
        let particles = sheet.particles_of(index as u32 - first_patch);
        let first = (first_offset + sheet.first_of(index as u32 - first_patch)) as usize;
        let places = &self.end[first_particle as usize..];
        let each = particles.iter().map(|&particle| places[particle as usize]);
        state.end = each.clone().sum::<Vec3A>() / particles.len() as f32;
        let squares = each
            .zip(&self.offsets[first..])
            .map(|(place, offset)| (place - state.end - *offset).length_squared());
        state.deviation[1] = squares.fold(0.0, f32::max).sqrt();
        self.ends[index] = state.end.extend(state.used());
    }

    /// Ends the sub-step: the next one begins where it ended. Patches that deviate from their references by more than
    /// `most` (m) get new ones.
    pub fn pass(&mut self, cloths: &[Participant], most: f32) {
        std::mem::swap(&mut self.start, &mut self.end);
        self.drifted = Vec3A::ZERO;
        for (index, patch) in self.patches.iter_mut().enumerate() {
            patch.start = patch.end;
            patch.deviation[0] = patch.deviation[1];
            // Also for NaN.
            if patch.deviation[0] <= most {
                continue;
            }
            let [first_particle, first_patch, first_offset, _] = self.firsts[patch.cloth as usize];
            let (sheet, own) = (
                &cloths[patch.cloth as usize].sheet,
                index as u32 - first_patch,
            );
            let particles = sheet.particles_of(own);
            let first = (first_offset + sheet.first_of(own)) as usize;
            let offsets = &mut self.offsets[first..first + particles.len()];
            patch.half = Vec3A::ZERO;
            for (&particle, offset) in particles.iter().zip(offsets) {
                *offset = self.start[(first_particle + particle) as usize] - patch.start;
                patch.half = patch.half.max(offset.abs());
            }
            patch.earlier += patch.deviation[0];
            patch.deviation = [0.0; 2];
        }
    }
}
