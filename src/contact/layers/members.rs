//! The particles of pairs that may touch in a sub-step, in one array.

use bevy::math::Vec3A;

use super::{mean_pushes::MeanPushes, motion::Motion, origin::Origin, participant::Participant};
use crate::cloth::{MapInline, Slot};

/// Only particles slower than this are held (m/s): a hold takes momentum, so only resting layers are held.
const RESTING_SPEED: f32 = 0.25;

/// No member, no pair.
pub(super) const NOBODY: u32 = u32::MAX;

/// The particles of pairs that may touch, from any cloth, in the common frame.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Members {
    of: Vec<Member>,
    /// The member of each particle, if it is one.
    member_of: Vec<u32>,
    /// Their states in the sub-step.
    pub states: Vec<State>,
    /// Their positions and motions at first, to find changes.
    gathered: Vec<[Vec3A; 2]>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Member {
    particle: u32,
    cloth: u32,
    slot: Slot,
}

impl Member {
    /// Its state. `before` has the positions before colliders pushed.
    #[inline]
    fn state(&self, cloths: &[Participant], motion: &Motion, before: &Origin) -> State {
        let cloth = &cloths[self.cloth as usize];
        let Slot { block, lane } = self.slot;
        let block = &cloth.particles.blocks()[block];
        let push = before.moved(self.cloth as usize, self.slot, block.position(lane));
        let push = Vec3A::from(cloth.vector(push.unwrap_or_default()));
        State {
            place: motion.end[self.particle as usize],
            start: motion.start[self.particle as usize],
            moved: cloth.vector(block.displacement(lane)).into(),
            support: push.normalize_or_zero(),
            inverse_mass: if cloth.is_fixed {
                0.0
            } else {
                block.inverse_mass(lane)
            },
            is_supported: push != Vec3A::ZERO,
        }
    }
}

/// A particle in a sub-step.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct State {
    /// Position (m).
    pub place: Vec3A,
    /// Position at the beginning of the sub-step (m).
    pub start: Vec3A,
    /// Displacement in the sub-step that counts as motion (m).
    pub moved: Vec3A,
    /// Direction of a collider's push in the sub-step, of length 1; 0 without one. The particle cannot move against it.
    pub support: Vec3A,
    /// Inverse mass (1/kg).
    pub inverse_mass: f32,
    /// Whether a collider pushed it.
    pub is_supported: bool,
}

impl Members {
    /// Begins a sub-step without members.
    pub fn clear(&mut self, particles: usize) {
        if self.member_of.len() == particles {
            for member in &self.of {
                self.member_of[member.particle as usize] = NOBODY;
            }
        } else {
            self.member_of.clear();
            self.member_of.resize(particles, NOBODY);
        }
        self.of.clear();
        self.states.clear();
        self.gathered.clear();
    }

    #[inline]
    pub fn len(&self) -> usize {
        self.of.len()
    }

    /// The member of a particle, which is added if it is new. `before` has the positions before colliders pushed.
    #[inline]
    pub fn of(
        &mut self,
        particle: u32,
        cloths: &[Participant],
        motion: &Motion,
        before: &Origin,
    ) -> u32 {
        let known = self.member_of[particle as usize];
        if known != NOBODY {
            return known;
        }
        let index = self.of.len() as u32;
        self.member_of[particle as usize] = index;
        let (own, local) = motion.cloth_of(particle);
        let member = Member {
            particle,
            cloth: own as u32,
            slot: cloths[own].particles.layout().slot_of(local),
        };
        let state = member.state(cloths, motion, before);
        self.of.push(member);
        self.gathered.push([state.place, state.moved]);
        self.states.push(state);
        index
    }

    /// Reads the states of the same members in a new sub-step.
    pub fn gather(&mut self, cloths: &[Participant], motion: &Motion, before: &Origin) {
        let each = self.of.iter().zip(&mut self.states);
        for ((member, state), gathered) in each.zip(&mut self.gathered) {
            *state = member.state(cloths, motion, before);
            *gathered = [state.place, state.moved];
        }
    }

    /// Puts their positions among those of all particles.
    pub fn put(&self, cloths: &[Participant], motion: &mut Motion) {
        for (member, state) in self.of.iter().zip(&self.states) {
            motion.put(cloths, member.particle, state.place);
        }
    }

    /// Writes changes back to the particles. Marks the affected cloths, and updates the means of their pushes.
    pub fn scatter(
        &self,
        cloths: &mut [Participant],
        is_pushed: &mut [bool],
        means: &mut MeanPushes,
    ) {
        for ((member, state), &[was, moved_by]) in
            self.of.iter().zip(&self.states).zip(&self.gathered)
        {
            let (index, slot) = (member.cloth as usize, member.slot);
            let cloth = &mut cloths[index];
            let push = state.place - was;
            let slowed = state.moved - moved_by;
            if push == Vec3A::ZERO && slowed == Vec3A::ZERO {
                continue;
            }
            is_pushed[index] = true;
            let push = cloth.own_vector(push.into());
            let moved = cloth.own_vector(state.moved.into());
            let block = &mut cloth.particles.blocks_mut()[slot.block];
            block.set_position(slot.lane, block.position(slot.lane) + push);
            block.set_displacement(slot.lane, moved);
            if state.inverse_mass != 0.0 {
                means.add(index, slot, cloth.own_vector(slowed.into()));
            }
        }
    }

    /// The four particles of a pair.
    #[inline]
    pub fn states(&self, of: [u32; 4]) -> [&State; 4] {
        of.map_inline(|member| &self.states[member as usize])
    }

    /// Whether all are slow in a sub-step of `dt` (s), and a collider or a pin holds some.
    pub fn are_resting(&self, dt: f32) -> bool {
        let square = (RESTING_SPEED * dt).powi(2);
        let is_slow = |state: &State| state.moved.length_squared() <= square;
        self.states
            .iter()
            .any(|state| state.is_supported || state.inverse_mass == 0.0)
            && self.states.iter().all(is_slow)
    }

    /// Largest push of any member since all were read (m).
    pub fn farthest_push(&self) -> f32 {
        let each = self.states.iter().zip(&self.gathered);
        let squares = each.map(|(state, [was, _])| (state.place - *was).length_squared());
        squares.fold(0.0, f32::max).sqrt()
    }
}
