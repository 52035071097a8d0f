//! The particles of all pairs, side by side.

use bevy::math::Vec3;

use super::participant::Participant;
use crate::cloth::Slot;

/// The particles that some pair names, whichever cloth they are of, in the common frame: what is done in each sub-step reads
/// nothing else.
#[derive(Debug, Default, Clone)]
pub(super) struct Members {
    of: Vec<Member>,
    /// Where they were as the sub-step began (m).
    pub start: Vec<Vec3>,
    /// Where they are (m).
    pub place: Vec<Vec3>,
    /// What the sub-step moved them by, as far as it is motion (m).
    pub moved: Vec<Vec3>,
    /// Inverse masses (1/kg).
    pub inverse_mass: Vec<f32>,
    /// How far each has travelled since it became one, besides what all have in common, up to this sub-step and in it (m).
    travelled: Vec<f32>,
    step: Vec<f32>,
    /// Places and motions as they were gathered, to find what has been changed.
    gathered: Vec<[Vec3; 2]>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Member {
    cloth: u32,
    slot: Slot,
}

impl Members {
    pub fn clear(&mut self) {
        self.of.clear();
        self.start.clear();
        self.travelled.clear();
        self.step.clear();
    }

    pub fn len(&self) -> usize {
        self.of.len()
    }

    /// Adds a particle of a cloth that was there as the sub-step began (m). Returns its place.
    pub fn add(&mut self, cloth: u32, slot: Slot, start: Vec3) -> u32 {
        self.of.push(Member { cloth, slot });
        self.start.push(start);
        self.travelled.push(0.0);
        self.step.push(0.0);
        self.of.len() as u32 - 1
    }

    /// Takes where they are for where the coming sub-step begins.
    pub fn begin(&mut self, cloths: &[Participant]) {
        self.start.clear();
        self.start.extend(self.of.iter().map(|member| {
            let cloth = &cloths[member.cloth as usize];
            cloth.point(cloth.particles.blocks()[member.slot.block].position(member.slot.lane))
        }));
    }

    /// Takes over where particles are now.
    pub fn gather(&mut self, cloths: &[Participant]) {
        self.place.clear();
        self.moved.clear();
        self.inverse_mass.clear();
        for member in &self.of {
            let cloth = &cloths[member.cloth as usize];
            let Slot { block, lane } = member.slot;
            let block = &cloth.particles.blocks()[block];
            self.place.push(cloth.point(block.position(lane)));
            self.moved.push(cloth.vector(block.displacement(lane)));
            let inverse_mass = if cloth.is_fixed {
                0.0
            } else {
                block.inverse_mass(lane)
            };
            self.inverse_mass.push(inverse_mass);
        }
        self.gathered.clear();
        let both = self.place.iter().zip(&self.moved);
        self.gathered
            .extend(both.map(|(&place, &moved)| [place, moved]));
    }

    /// Gives the particles back what was changed, and begins the next sub-step there. Marks the cloths of which any was.
    pub fn scatter(&mut self, cloths: &mut [Participant], is_pushed: &mut [bool]) {
        for (index, member) in self.of.iter().enumerate() {
            let place = self.place[index];
            let [was, moved_by] = self.gathered[index];
            let push = place - was;
            if push != Vec3::ZERO || self.moved[index] != moved_by {
                let cloth = &mut cloths[member.cloth as usize];
                is_pushed[member.cloth as usize] = true;
                let push = cloth.own_vector(push);
                let moved = cloth.own_vector(self.moved[index]);
                let Slot { block, lane } = member.slot;
                let block = &mut cloth.particles.blocks_mut()[block];
                block.set_position(lane, block.position(lane) + push);
                block.set_displacement(lane, moved);
            }
            self.start[index] = place;
            self.travelled[index] += self.step[index];
        }
    }

    /// The four particles of a pair, at the start of the sub-step (m).
    #[inline]
    pub fn starts(&self, of: [u32; 4]) -> [Vec3; 4] {
        of.map(|member| self.start[member as usize])
    }

    /// Likewise, where they are now (m).
    #[inline]
    pub fn places(&self, of: [u32; 4]) -> [Vec3; 4] {
        of.map(|member| self.place[member as usize])
    }

    /// Likewise, what the sub-step moved them by (m).
    #[inline]
    pub fn motions(&self, of: [u32; 4]) -> [Vec3; 4] {
        of.map(|member| self.moved[member as usize])
    }

    /// Likewise, their inverse masses (1/kg).
    #[inline]
    pub fn inverse_masses(&self, of: [u32; 4]) -> [f32; 4] {
        of.map(|member| self.inverse_mass[member as usize])
    }

    /// How far the four particles of a pair have travelled, all together: up to this sub-step, and with it (m).
    #[inline]
    pub fn travelled(&self, of: [u32; 4]) -> [f32; 2] {
        let sum = |each: &[f32]| of.iter().map(|&member| each[member as usize]).sum::<f32>();
        let before = sum(&self.travelled);
        [before, before + sum(&self.step)]
    }

    /// Measures how far each has come in the sub-step. Returns how far any two of them can have come nearer to each other (m).
    pub fn approach(&mut self) -> f32 {
        let sum = |of: &[Vec3]| of.iter().sum::<Vec3>();
        let drift = (sum(&self.place) - sum(&self.start)) / self.len().max(1) as f32;
        let mut farthest = 0.0_f32;
        let both = self.place.iter().zip(&self.start);
        for ((place, start), step) in both.zip(&mut self.step) {
            *step = (place - start - drift).length();
            farthest = farthest.max(*step);
        }
        2.0 * farthest
    }
}
