//! Loads of all particles.

use bevy::math::Vec3;

use super::{ClothParticles, load::Load};

impl ClothParticles {
    /// Loads in the coming sub-step, or in the last: at most one for each particle.
    pub(crate) fn loads_mut(&mut self) -> &mut Vec<Load> {
        &mut self.loads
    }

    /// Whether any particle has a load in the coming sub-step.
    pub(crate) fn has_loads(&self) -> bool {
        !self.loads.is_empty()
    }

    /// Adds all loads to their particles after a sub-step's prediction. `pull` is the displacement by gravity in it
    /// (m).
    pub(crate) fn put_loads_on(&mut self, pull: Vec3) {
        for load in &mut self.loads {
            load.put_on(&mut self.blocks, pull);
        }
    }

    /// Removes them.
    pub(crate) fn take_loads_off(&mut self) {
        for load in &mut self.loads {
            load.take_off(&mut self.blocks);
        }
    }
}
