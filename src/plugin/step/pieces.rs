//! Pieces of torn cloth that sleep while others move: within a tick, their particles are held as if pinned.

use bevy::math::Vec3;

use super::tick::IntegrateQueryItem;
use crate::solver::{RestLimits, TickStep};

/// Finds the pieces that sleep, now that the colliders near them are known, and holds them.
pub(super) fn hold_sleeping_pieces(cloth: &mut IntegrateQueryItem, step: &TickStep) {
    let (state, scratch) = (&mut *cloth.state, &*cloth.scratch);
    let surface = cloth.built.surface();
    let sleeps = (state.inputs.known).is_some_and(|known| known.settings.sleeps);
    if !(sleeps && surface.is_torn() && surface.pieces() > 1) {
        return;
    }
    // Tethers and ways out of a collider move particles whatever their mass.
    if !cloth.built.solver.tethers().is_empty() || scratch.detection.embedded() > 0.0 {
        state.resting.pieces.wake();
        return;
    }
    let layers = scratch.self_collision.filter(|of| of.with_itself);
    let (diagonal, gravity) = (surface.diagonal(), step.acceleration.length());
    let limits = scratch.rest_rule.limits(diagonal, gravity);
    let RestLimits { patience, .. } = limits;
    let (particles, pieces) = (&*cloth.particles, &mut state.resting.pieces);
    pieces.observe(surface, particles, &scratch.pins, limits, step.seconds);
    let touching = layers.map(|of| of.thickness + 2.0 * scratch.reach);
    let reach = scratch.contact_settings.particle_radius + surface.spacing().longest;
    pieces.fall_asleep(patience, touching, |piece| {
        piece.settle(&scratch.near, reach)
    });
    let (particles, held) = (&mut *cloth.particles, &mut cloth.scratch.held);
    let layout = particles.layout();
    for particle in cloth.state.resting.pieces.asleep() {
        let slot = layout.slot_of(particle as usize);
        let block = &mut particles.blocks_mut()[slot.block];
        let inverse_mass = block.inverse_mass(slot.lane);
        if inverse_mass > 0.0 {
            held.push((slot, inverse_mass));
            block.set_inverse_mass(slot.lane, 0.0);
            block.set_displacement(slot.lane, Vec3::ZERO);
        }
    }
    cloth.stats.sleeping_particles = held.len();
}

/// Gives the particles that were held their masses back.
pub(super) fn let_pieces_go(cloth: &mut IntegrateQueryItem) {
    for (slot, inverse_mass) in cloth.scratch.held.drain(..) {
        let block = &mut cloth.particles.blocks_mut()[slot.block];
        block.set_inverse_mass(slot.lane, inverse_mass);
    }
}
