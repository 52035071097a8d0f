//! The particles of all pairs, in one array.

use bevy::math::{Vec3, Vec3A};

use super::{hold::Hold, participant::Participant};
use crate::cloth::Slot;

/// The particles of all pairs, from any cloth, in the common frame. Each sub-step reads only these.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Members {
    of: Vec<Member>,
    /// Their states in the sub-step.
    pub states: Vec<State>,
    /// Their positions before colliders pushed them in the sub-step (m), if noted.
    before_colliders: Vec<Vec3A>,
    /// Their positions and motions at the beginning, to find changes.
    gathered: Vec<[Vec3A; 2]>,
    /// The distance that each has travelled since it was added, without the common motion, and its position at the
    /// measurement (m).
    travelled: Vec<f32>,
    measured: Vec<Vec3A>,
    /// Mean change of each particle's motion by its last pushes (m per sub-step).
    held: Vec<Vec3A>,
}

/// Weight of the latest push in the mean. The particles that carry a layer's weight vary from one sub-step to the next.
const LATEST: f32 = 0.3;

#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Member {
    cloth: u32,
    slot: Slot,
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
    pub fn clear(&mut self) {
        self.of.clear();
        self.states.clear();
        self.travelled.clear();
        self.held.clear();
        self.measured.clear();
        self.before_colliders.clear();
    }

    pub fn len(&self) -> usize {
        self.of.len()
    }

    /// Position of a member at the beginning of the sub-step (m).
    pub fn start(&self, member: u32) -> Vec3 {
        self.states[member as usize].start.into()
    }

    /// Adds a particle of a cloth with its position at the beginning of the sub-step (m). It may be `known` from
    /// before. Returns its index.
    pub fn add(&mut self, cloth: u32, slot: Slot, start: Vec3, known: Option<(&Self, u32)>) -> u32 {
        let start = start.into();
        self.of.push(Member { cloth, slot });
        self.states.push(State {
            start,
            ..State::default()
        });
        self.travelled.push(0.0);
        let held = known.map(|(before, member)| before.held[member as usize]);
        self.held.push(held.unwrap_or_default());
        self.measured.push(start);
        self.of.len() as u32 - 1
    }

    /// Sets the start of the coming sub-step to the current positions.
    pub fn begin(&mut self, cloths: &[Participant]) {
        for (state, member) in self.states.iter_mut().zip(&self.of) {
            state.start = cloths[member.cloth as usize].place(member.slot).into();
        }
    }

    /// Notes their positions before colliders push them.
    pub fn note_before_colliders(&mut self, cloths: &[Participant]) {
        self.before_colliders.clear();
        let each = self.of.iter();
        let places =
            each.map(|member| Vec3A::from(cloths[member.cloth as usize].place(member.slot)));
        self.before_colliders.extend(places);
    }

    /// Reads the particles' current positions.
    pub fn gather(&mut self, cloths: &[Participant]) {
        let is_noted = self.before_colliders.len() == self.len();
        self.gathered.clear();
        for (index, (state, member)) in self.states.iter_mut().zip(&self.of).enumerate() {
            let cloth = &cloths[member.cloth as usize];
            let Slot { block, lane } = member.slot;
            let block = &cloth.particles.blocks()[block];
            state.place = cloth.point(block.position(lane)).into();
            state.moved = cloth.vector(block.displacement(lane)).into();
            state.inverse_mass = if cloth.is_fixed {
                0.0
            } else {
                block.inverse_mass(lane)
            };
            // Without a note, supports stay the same.
            if is_noted {
                let push = state.place - self.before_colliders[index];
                state.is_supported = push != Vec3A::ZERO;
                if state.is_supported {
                    state.support = push.normalize_or_zero();
                }
            }
            self.gathered.push([state.place, state.moved]);
        }
        self.before_colliders.clear();
    }

    /// Writes changes back to the particles, and begins the next sub-step there. Marks the affected cloths, and updates
    /// their holds.
    pub fn scatter(&mut self, cloths: &mut [Participant], is_pushed: &mut [bool], hold: &mut Hold) {
        let each = self.of.iter().zip(&mut self.states).zip(&mut self.held);
        for (((member, state), held), &[was, moved_by]) in each.zip(&self.gathered) {
            let (index, slot) = (member.cloth as usize, member.slot);
            let cloth = &mut cloths[index];
            let push = state.place - was;
            let slowed = state.moved - moved_by;
            if push != Vec3A::ZERO || slowed != Vec3A::ZERO {
                is_pushed[index] = true;
                let push = cloth.own_vector(push.into());
                let moved = cloth.own_vector(state.moved.into());
                let block = &mut cloth.particles.blocks_mut()[slot.block];
                block.set_position(slot.lane, block.position(slot.lane) + push);
                block.set_displacement(slot.lane, moved);
            }
            *held = if state.inverse_mass == 0.0 {
                Vec3A::ZERO
            } else {
                *held + LATEST * (slowed - *held)
            };
            hold.set(index, slot, cloth.own_vector((*held).into()));
            state.start = state.place;
        }
    }

    /// The four particles of a pair.
    #[inline]
    pub fn states(&self, of: [u32; 4]) -> [&State; 4] {
        of.map(|member| &self.states[member as usize])
    }

    /// Their positions at the beginning of the sub-step (m).
    #[inline]
    pub fn starts(&self, of: [u32; 4]) -> [Vec3; 4] {
        of.map(|member| self.start(member))
    }

    /// Total distance that the four particles of a pair have travelled up to the last measurement (m).
    #[inline]
    pub fn travelled(&self, of: [u32; 4]) -> f32 {
        let [a, b, c, d] = of.map(|member| self.travelled[member as usize]);
        a + b + c + d
    }

    /// Measures the distance that each has travelled up to the beginning of the sub-step.
    pub fn note_travel(&mut self) {
        let from: Vec3A = self.measured.iter().sum();
        let to: Vec3A = self.states.iter().map(|state| state.start).sum();
        let drift = (to - from) / self.len().max(1) as f32;
        let each = self.states.iter().zip(&mut self.measured);
        for ((state, measured), travelled) in each.zip(&mut self.travelled) {
            *travelled += (state.start - *measured - drift).length();
            *measured = state.start;
        }
    }

    /// Whether none moved farther than this (m), and a collider or a pin holds some.
    pub fn are_resting(&self, farthest: f32) -> bool {
        let square = farthest * farthest;
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
