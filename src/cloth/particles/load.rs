//! Bodies that particles carry.

use bevy::math::Vec3;

use crate::cloth::{Block, Slot};

/// A part of a body's mass that a particle carries while a sub-step's springs are solved: so they hold what lies on them, and not the
/// particle alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Load {
    /// The particle.
    pub slot: Slot,
    /// Mass (kg).
    pub mass: f32,
    /// Which way the body pushes the particle, of length 1: along that they go together.
    pub way: Vec3,
    /// How far the body's surface there goes in the sub-step by itself (m).
    pub surface: Vec3,
    /// What the sub-step moved it by, more than it would have gone (m).
    pub moved: Vec3,
    /// As it would have gone (m).
    alone: Vec3,
    /// Of the particle alone.
    inverse_mass: f32,
}

impl Load {
    /// Of a mass (kg) on a particle.
    pub fn new(slot: Slot, mass: f32, way: Vec3, surface: Vec3) -> Self {
        Self {
            slot,
            mass,
            way,
            surface,
            moved: Vec3::ZERO,
            alone: Vec3::ZERO,
            inverse_mass: 0.0,
        }
    }

    /// Adds it to its particle, which a sub-step has just been foreseen for: both go on with the momentum that they have together. `pull`
    /// is what gravity alone moves a particle by in that (m): the body has its own, from whoever moves it.
    pub fn put_on(&mut self, blocks: &mut [Block], pull: Vec3) {
        let Slot { block, lane } = self.slot;
        let block = &mut blocks[block];
        self.inverse_mass = block.inverse_mass(lane);
        if self.inverse_mass == 0.0 {
            return;
        }
        let foreseen = block.displacement(lane);
        let before = foreseen - pull;
        self.alone = before + self.way * self.way.dot(self.surface - before);
        let own_part = 1.0 / (1.0 + self.mass * self.inverse_mass);
        block.set_displacement(lane, self.alone.lerp(foreseen, own_part));
        block.set_inverse_mass(lane, self.inverse_mass * own_part);
    }

    /// Takes it off, after the springs were solved.
    pub fn take_off(&mut self, blocks: &mut [Block]) {
        let Slot { block, lane } = self.slot;
        if self.inverse_mass == 0.0 {
            return;
        }
        let block = &mut blocks[block];
        block.set_inverse_mass(lane, self.inverse_mass);
        self.moved = block.displacement(lane) - self.alone;
    }
}
