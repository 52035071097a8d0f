//! Operations of the solver and the plugin on all particles.

use bevy::math::{DVec3, Isometry3d, Vec3};

use super::{
    AFTER_A_JUMP, ClothParticles, DensityFactors,
    past::{Earlier, StepKind},
    validity::is_valid,
};
use crate::cloth::{
    arrays::MapInline,
    lanes::{Block, DX, DY, DZ, LANES, Layout, Slot, W, X, larger},
    material::ClothMaterial,
    pins::Pins,
    quantity::QuantityError,
    surface::Surface,
};

/// The result of one pass over the particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Survey {
    /// Whether all particles pass [`ClothParticles::validate`].
    pub is_valid: bool,
    /// Speed of the fastest particle (m/s).
    pub largest_speed: f32,
}

impl ClothParticles {
    /// Sets the inverse masses from the surface's areas, the material's density times these factors, and the pins, which must be valid
    /// for the surface.
    ///
    /// # Errors
    /// A particle mass outside 10⁻¹⁵ to 10¹⁵ kg. Nothing changes then.
    pub(crate) fn assign_masses(
        &mut self,
        surface: &Surface,
        material: &ClothMaterial,
        factors: &DensityFactors,
        pins: &Pins,
    ) -> Result<(), QuantityError> {
        factors.check(surface, material)?;
        for index in 0..self.layout.len() {
            self.assign_mass(index, surface, material, factors);
        }
        pins.for_each(surface, |index| self.pin(index));
        self.past.forget(AFTER_A_JUMP);
        Ok(())
    }

    /// Sets the inverse masses of free particles alone. Their motion goes on.
    ///
    /// # Errors
    /// A particle mass outside 10⁻¹⁵ to 10¹⁵ kg. Nothing changes then.
    pub(crate) fn weigh(
        &mut self,
        surface: &Surface,
        material: &ClothMaterial,
        factors: &DensityFactors,
    ) -> Result<(), QuantityError> {
        factors.check(surface, material)?;
        for (index, slot) in self.layout.slots().enumerate() {
            let block = &mut self.blocks[slot.block];
            if block.inverse_mass(slot.lane) > 0.0 {
                let mass = factors.mass(index, surface, material);
                block.set_inverse_mass(slot.lane, 1.0 / mass);
            }
        }
        Ok(())
    }

    /// Moves each free particle off the surface at rest, by at most `unevenness` spacings. The offset is a function of
    /// the particle's index, so equal cloths begin equal.
    pub(crate) fn make_uneven(
        &mut self,
        surface: &Surface,
        unevenness: f32,
        is_held: impl Fn(usize) -> bool,
    ) {
        let farthest = unevenness * surface.spacing().typical;
        for (index, slot) in self.layout.slots().enumerate() {
            let block = &mut self.blocks[slot.block];
            if block.inverse_mass(slot.lane) > 0.0 && !is_held(index) {
                let away = farthest * surface.normal_of(index);
                let position = block.position(slot.lane) + away * scattered(index as u64);
                block.set_position(slot.lane, position);
            }
        }
    }

    /// Pins a particle: only its pin moves it.
    pub(crate) fn pin(&mut self, index: usize) {
        let slot = self.layout.slot_of(index);
        self.blocks[slot.block].set_inverse_mass(slot.lane, 0.0);
        self.past.forget(AFTER_A_JUMP);
    }

    /// Checks every particle once.
    pub(crate) fn survey(&self) -> Survey {
        let mut valid = [true; LANES];
        let mut largest = [0.0_f32; LANES];
        for block in &self.blocks {
            let view = block.view();
            let square = |from: usize, lane: usize| {
                let [a, b, c] = [0, LANES, 2 * LANES].map_inline(|next| view[from + next + lane]);
                a * a + b * b + c * c
            };
            for lane in 0..LANES {
                let moved = square(DX, lane);
                valid[lane] &= is_valid(square(X, lane) + moved, view[W + lane]);
                largest[lane] = larger(moved, largest[lane]);
            }
        }
        Survey {
            is_valid: valid == [true; LANES] && self.is_stepped(),
            largest_speed: largest.into_iter().fold(0.0, f32::max).sqrt() / self.substep,
        }
    }

    /// Masses of the lightest and the heaviest free particle (kg); 0 if all are pinned.
    pub(crate) fn free_masses(&self) -> [f32; 2] {
        let free = self.inverse_masses().filter(|w| *w > 0.0);
        let ends = free.fold([0.0, f32::INFINITY], |[light, heavy]: [f32; 2], w| {
            [light.max(w), heavy.min(w)]
        });
        if ends[0] > 0.0 {
            ends.map_inline(f32::recip)
        } else {
            [0.0; 2]
        }
    }

    /// Whether the number and the layout of the particles match the surface.
    pub(crate) fn matches(&self, surface: &Surface) -> bool {
        self.layout == surface.layout() && self.blocks.len() == self.layout.blocks()
    }

    /// Position (m) of a particle that exists.
    #[inline]
    pub(crate) fn position_at(&self, index: usize) -> Vec3 {
        let Slot { block, lane } = self.layout.slot_of(index);
        self.blocks[block].position(lane)
    }

    /// The memory layout.
    pub(crate) fn layout(&self) -> Layout {
        self.layout
    }

    /// The blocks.
    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// The blocks, and the particles' earlier displacements.
    pub(crate) fn blocks_and_past(&mut self) -> (&mut [Block], &mut [Earlier]) {
        (&mut self.blocks, &mut self.past.blocks)
    }

    /// The order of the coming sub-step, if second order is enabled.
    pub(crate) fn next_step(&mut self) -> StepKind {
        self.past.next(self.blocks.len())
    }

    /// Forgets the displacements before the last, and takes this many first-order sub-steps first.
    ///
    /// In a second-order method, velocity is the last displacement plus half of its last change. In a cloth without
    /// pins, all particles keep the mean of that change, so that momentum is conserved. The change is that of the
    /// sub-step before, because the last displacement may contain a push.
    pub(crate) fn forget_past(&mut self, wait: u32) {
        if self.past.known().is_some() {
            let gained = self.mean_gain();
            if gained != Vec3::ZERO {
                for Slot { block, lane } in self.layout.slots() {
                    self.blocks[block].displace(lane, 0.5 * gained);
                }
            }
        }
        self.past.forget(wait);
    }

    /// The mean change of displacements from one sub-step to the next, before the last (m), weighted by mass; 0 if a
    /// particle is pinned.
    fn mean_gain(&self) -> Vec3 {
        let (mut sum, mut mass) = (DVec3::ZERO, 0.0);
        for Slot { block, lane } in self.layout.slots() {
            let weight = self.blocks[block].inverse_mass(lane);
            if weight == 0.0 {
                return Vec3::ZERO;
            }
            let own = 1.0 / f64::from(weight);
            sum += own * self.past.blocks[block].gain(lane).as_dvec3();
            mass += own;
        }
        (sum / mass).as_vec3()
    }

    /// Adds `displacement` per sub-step (m) to a particle's motion, in the history too.
    pub(crate) fn accelerate(&mut self, slot: Slot, displacement: Vec3) {
        self.blocks[slot.block].displace(slot.lane, displacement);
        self.past
            .change(slot.block, slot.lane, |moved| moved + displacement);
    }

    /// The blocks.
    pub(crate) fn blocks_mut(&mut self) -> &mut [Block] {
        &mut self.blocks
    }

    /// Resets lanes that hold no particle: NaN may have spread into them.
    pub(crate) fn clear_padding(&mut self) {
        for index in 0..self.blocks.len() {
            let mut clean = Block::EMPTY;
            let was = self.blocks[index];
            for lane in 0..LANES {
                if self.layout.index_at(index, lane).is_some() {
                    clean.set_position(lane, was.position(lane));
                    clean.set_displacement(lane, was.displacement(lane));
                    clean.set_inverse_mass(lane, was.inverse_mass(lane));
                }
            }
            self.blocks[index] = clean;
        }
    }

    /// Sets a particle's mass from surface and material.
    pub(crate) fn assign_mass(
        &mut self,
        index: usize,
        surface: &Surface,
        material: &ClothMaterial,
        factors: &DensityFactors,
    ) {
        let mass = factors.mass(index, surface, material);
        let Slot { block, lane } = self.layout.slot_of(index);
        self.blocks[block].set_inverse_mass(lane, 1.0 / mass);
        self.past.forget(AFTER_A_JUMP);
    }

    /// Sets the displacements of pinned particles to zero.
    pub(crate) fn zero_pin_displacements(&mut self) {
        for block in &mut self.blocks {
            let view = block.view_mut();
            for from in [DX, DY, DZ] {
                for lane in 0..LANES {
                    let moved = view[from + lane];
                    view[from + lane] = if view[W + lane] > 0.0 { moved } else { 0.0 };
                }
            }
        }
    }

    /// Sets the position of a pinned particle at the end of the sub-step.
    pub(crate) fn set_pin_target(&mut self, index: usize, position: Vec3) {
        let Slot { block, lane } = self.layout.slot_of(index);
        let block = &mut self.blocks[block];
        block.set_displacement(lane, position - block.position(lane));
    }

    /// Moves all particles as one body, and rotates their velocities.
    pub(crate) fn transform(&mut self, by: Isometry3d) {
        for slot in self.layout.slots() {
            let block = &mut self.blocks[slot.block];
            block.set_position(slot.lane, by * block.position(slot.lane));
            block.set_displacement(slot.lane, by.rotation * block.displacement(slot.lane));
            self.past
                .change(slot.block, slot.lane, |moved| by.rotation * moved);
        }
    }

    /// Copies `other` into the existing allocation.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.copy_places_from(other);
        self.substep = other.substep;
        self.past.copy_from(&other.past);
        self.loads.clone_from(&other.loads);
    }

    /// Copies `other` except its history into the existing allocation, as earlier positions.
    pub(crate) fn copy_places_from(&mut self, other: &Self) {
        self.layout = other.layout;
        self.blocks.clone_from(&other.blocks);
    }

    /// Sets the position of a particle.
    pub(crate) fn put(&mut self, index: usize, position: Vec3) {
        let Slot { block, lane } = self.layout.slot_of(index);
        self.blocks[block].set_position(lane, position);
    }

    /// The sub-step that displacements span (s).
    pub(crate) fn substep(&self) -> f32 {
        self.substep
    }

    /// Sets the sub-step that displacements span (s), and keeps the velocities.
    pub(crate) fn set_substep(&mut self, substep: f32) {
        if substep != self.substep {
            let ratio = substep / self.substep;
            self.substep = substep;
            self.past.restart(&mut self.blocks, ratio);
        }
    }

    /// Sets displacements to velocity × sub-step, and forgets the rest of the history.
    pub(crate) fn end_past(&mut self) {
        self.past.end(&mut self.blocks);
    }

    /// Gives all particles the velocities of one rigid body that moves `by` this motion in `seconds`, or zero if
    /// `seconds` is zero. Positions do not change.
    pub(crate) fn set_body_motion(&mut self, by: Isometry3d, seconds: f32) {
        let share = self.substep / seconds;
        let part = if seconds > 0.0 { share } else { 0.0 };
        for slot in self.layout.slots() {
            let block = &mut self.blocks[slot.block];
            let position = block.position(slot.lane);
            let is_free = block.inverse_mass(slot.lane) > 0.0;
            let moved = (by * position - position) * part;
            block.set_displacement(slot.lane, if is_free { moved } else { Vec3::ZERO });
        }
        self.past.forget(0);
    }
}

/// A pseudorandom number from −1 to 1 that depends only on `index` (Steele, Lea and Flood 2014, `SplitMix`).
fn scattered(index: u64) -> f32 {
    let mut bits = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    // A float holds 24 bits.
    (bits >> 40) as f32 / (1 << 23) as f32 - 1.0
}
