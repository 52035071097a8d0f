//! What all particles carry.

use bevy::math::Vec3;

use super::{ClothParticles, load::Load};

impl ClothParticles {
    /// What they carry in the coming sub-step, or carried in the last: no particle more than once.
    pub(crate) fn loads_mut(&mut self) -> &mut Vec<Load> {
        &mut self.loads
    }

    /// Whether they carry anything in the coming sub-step.
    pub(crate) fn has_loads(&self) -> bool {
        !self.loads.is_empty()
    }

    /// Adds all loads to their particles, which a sub-step has just been foreseen for, with what gravity moves a particle by in
    /// that (m).
    pub(crate) fn put_loads_on(&mut self, pull: Vec3) {
        for load in &mut self.loads {
            load.put_on(&mut self.blocks, pull);
        }
    }

    /// Takes them off again.
    pub(crate) fn take_loads_off(&mut self) {
        for load in &mut self.loads {
            load.take_off(&mut self.blocks);
        }
    }
}
