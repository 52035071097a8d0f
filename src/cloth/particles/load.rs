//! Bodies that particles carry.

use bevy::math::Vec3;

use crate::cloth::lanes::{Block, Slot};

/// Tolerance of a body's bounce at rest, in pulls of gravity. Gravity acts on a body once a tick, and the cloth returns
/// that momentum sub-step by sub-step. So a resting body leaves its particles by a few sub-steps' pull, or by a
/// fraction of their common motion.
const SAME_PULLS: f32 = 64.0;
const SAME_WAY: f32 = 0.1;

/// A part of a body's mass that a particle carries while the springs of a sub-step are solved. So the springs hold the
/// body's weight as well as the particle's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Load {
    /// The particle.
    pub slot: Slot,
    /// Mass (kg).
    pub mass: f32,
    /// Outward normal of the body there, of length 1.
    pub normal: Vec3,
    /// Motion of the body's surface there in the sub-step, without the cloth (m).
    pub surface: Vec3,
    /// Displacement that the sub-step added to `alone` (m).
    pub moved: Vec3,
    /// Displacement without the springs (m).
    alone: Vec3,
    /// Inverse mass of the particle without the load.
    inverse_mass: f32,
}

impl Load {
    /// A load of a mass (kg) on a particle.
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

    /// Adds the load to its particle after a sub-step's prediction: both continue with their common momentum. `pull` is
    /// the displacement by gravity alone in the sub-step (m); the body already has its own from the physics engine. The
    /// load moves with the body's surface and holds the particle like friction without a limit. A body that leaves the
    /// particle is not carried.
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

    /// Removes the load, after the springs were solved.
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
