//! Particles that move as one body.

use bevy::math::{Isometry3d, Vec3};

use super::ClothParticles;

impl ClothParticles {
    /// Gives all particles the velocities of one rigid body that moves `by` this motion in `seconds`, or zero if
    /// `seconds` is zero. Positions do not change.
    pub(crate) fn set_body_motion(&mut self, by: Isometry3d, seconds: f32) {
        let part = if seconds > 0.0 {
            self.substep / seconds
        } else {
            0.0
        };
        for slot in self.layout.slots() {
            let block = &mut self.blocks[slot.block];
            let position = block.position(slot.lane);
            let moved = if block.inverse_mass(slot.lane) > 0.0 {
                (by * position - position) * part
            } else {
                Vec3::ZERO
            };
            block.set_displacement(slot.lane, moved);
        }
        self.past.forget(0);
    }
}
