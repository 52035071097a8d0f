//! Bodies that particles carry.

use bevy::math::Vec3;

use crate::cloth::{Block, Slot};

/// What a body at rest is thrown up and down by: in a tick it gets its gravity at once, and cloth gives it back sub-step by sub-step. So
/// it leaves particles by some sub-steps' pull, or by a part of the way that both go.
const SAME_PULLS: f32 = 64.0;
const SAME_WAY: f32 = 0.1;

/// A part of a body's mass that a particle carries while a sub-step's springs are solved: so they hold what lies on them, and not the
/// particle alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Load {
    /// The particle.
    pub slot: Slot,
    /// Mass (kg).
    pub mass: f32,
    /// Out of the body in that place, of length 1.
    pub normal: Vec3,
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
    pub fn new(slot: Slot, mass: f32, normal: Vec3, surface: Vec3) -> Self {
        Self {
            slot,
            mass,
            normal,
            surface,
            moved: Vec3::ZERO,
            alone: Vec3::ZERO,
            inverse_mass: 0.0,
        }
    }

    /// Puts it on its particle, which a sub-step has just been foreseen for: both go on with the momentum that they have together. `pull`
    /// is what gravity alone moves a particle by in that (m): the body has its own, from whoever moves it. It goes as the body's surface does,
    /// which so has a hold of the particle as by friction without a limit; a body that leaves the particle behind is not carried.
    pub fn put_on(&mut self, blocks: &mut [Block], pull: Vec3) {
        let Slot { block, lane } = self.slot;
        let block = &mut blocks[block];
        self.inverse_mass = block.inverse_mass(lane);
        if self.inverse_mass == 0.0 {
            return;
        }
        let foreseen = block.displacement(lane);
        let before = foreseen - pull;
        let nearing = self.normal.dot(self.surface - before);
        let fastest = self.surface.length().max(before.length());
        // NaN is not carried.
        let stays = nearing >= -(SAME_PULLS * pull.length() + SAME_WAY * fastest);
        if !stays {
            self.inverse_mass = 0.0;
            return;
        }
        self.alone = self.surface;
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
