//! Pieces of torn cloth that sleep while others move: within a tick, their particles are held as if pinned.

use bevy::math::Vec3;

use super::tick::IntegrateQueryItem;
use crate::solver::{RestLimits, TickStep};

impl IntegrateQueryItem<'_, '_> {
    /// Finds the pieces that sleep, now that the colliders near them are known, and holds them.
    pub(super) fn hold_sleeping_pieces(&mut self, step: &TickStep) {
        let (state, scratch) = (&mut *self.state, &*self.scratch);
        let surface = self.built.surface();
        let sleeps = (state.inputs.known).is_some_and(|known| known.settings.sleeps);
        if !(sleeps && surface.is_torn() && surface.pieces() > 1) {
            return;
        }
        let layers = scratch.self_collision.filter(|of| of.with_itself);
        let (diagonal, gravity) = (surface.diagonal(), step.acceleration.length());
        let limits = scratch.rest_rule.limits(diagonal, gravity);
        let RestLimits { patience, .. } = limits;
        let (particles, pieces) = (&*self.particles, &mut state.resting.pieces);
        pieces.observe(surface, particles, &scratch.pins, limits, step.seconds);
        let touching = layers.map(|of| of.thickness + 2.0 * scratch.reach);
        let reach = scratch.contact_settings.particle_radius + surface.spacing().longest;
        pieces.fall_asleep(patience, touching, |piece| {
            piece.settle(&scratch.near, reach)
        });
        let (particles, held) = (&mut *self.particles, &mut self.scratch.held);
        let layout = particles.layout();
        for particle in self.state.resting.pieces.asleep() {
            let slot = layout.slot_of(particle as usize);
            let block = &mut particles.blocks_mut()[slot.block];
            let inverse_mass = block.inverse_mass(slot.lane);
            if inverse_mass > 0.0 {
                held.push((slot, inverse_mass));
                block.set_inverse_mass(slot.lane, 0.0);
                block.set_displacement(slot.lane, Vec3::ZERO);
            }
        }
        self.stats.sleeping_particles = held.len();
    }

    /// Gives the particles that were held their masses back.
    pub(super) fn let_pieces_go(&mut self) {
        for (slot, inverse_mass) in self.scratch.held.drain(..) {
            let block = &mut self.particles.blocks_mut()[slot.block];
            block.set_inverse_mass(slot.lane, inverse_mass);
        }
    }
}
