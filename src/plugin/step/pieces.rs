//! Pieces of torn cloth that sleep while others move: in a tick, their particles are as if pinned.

use bevy::{
    ecs::{
        change_detection::DetectChangesMut,
        query::{QueryData, With},
        system::Query,
    },
    math::Vec3,
};

use crate::{
    cloth::{ClothParticles, ClothTears},
    plugin::state::{ClothBuilt, ClothScratch, ClothState, ClothStats},
    solver::{RestLimits, RestRule},
};

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct PieceQuery {
    built: &'static ClothBuilt,
    particles: &'static mut ClothParticles,
    state: &'static mut ClothState,
    scratch: &'static mut ClothScratch,
    stats: &'static mut ClothStats,
}

/// Finds the pieces that sleep, once the colliders near them are known, and holds them.
pub(crate) fn hold_sleeping_pieces(mut cloths: Query<PieceQuery, With<ClothTears>>) {
    for mut cloth in &mut cloths {
        cloth.find_sleeping();
        cloth.hold();
    }
}

/// Gives them their masses back.
pub(crate) fn let_pieces_go(mut cloths: Query<PieceQuery, With<ClothTears>>) {
    for mut cloth in &mut cloths {
        let particles = cloth.particles.bypass_change_detection();
        let layout = particles.layout();
        for (particle, inverse_mass) in cloth.scratch.held.drain(..) {
            let slot = layout.slot_of(particle as usize);
            particles.blocks_mut()[slot.block].set_inverse_mass(slot.lane, inverse_mass);
        }
    }
}

impl PieceQueryItem<'_, '_> {
    fn find_sleeping(&mut self) {
        let (state, scratch) = (&mut *self.state, &*self.scratch);
        let surface = self.built.surface();
        let has_pieces = surface.is_torn() && surface.pieces() > 1;
        // Other cloths in an island move it, or are sewn to it.
        if !has_pieces || scratch.is_in_island {
            state.resting.pieces.wake();
            return;
        }
        let step = scratch.step.filter(|step| step.seconds > 0.0);
        let Some(step) = step.filter(|_| self.built.matches(&self.particles)) else {
            return;
        };
        if state.rest.is_asleep() {
            return;
        }
        let layers = scratch.self_collision.filter(|of| of.with_itself);
        let rule = match layers {
            Some(_) if state.layer_substeps > 0 => RestRule::Layers,
            _ => RestRule::Free,
        };
        let limits = rule.limits(surface.diagonal(), step.acceleration.length());
        let RestLimits { patience, .. } = limits;
        let (particles, pins) = (&*self.particles, &scratch.pins);
        (state.resting.pieces).observe(surface, particles, pins, limits, step.seconds);
        let touching = layers.map(|of| of.thickness + 2.0 * scratch.reach);
        let reach = scratch.contact_settings.particle_radius + surface.spacing().longest;
        (state.resting.pieces).fall_asleep(patience, touching, |piece| {
            piece.lies_still(&scratch.near, reach)
        });
    }

    fn hold(&mut self) {
        if self.state.rest.is_asleep() || self.scratch.step.is_none() {
            return;
        }
        let particles = self.particles.bypass_change_detection();
        let layout = particles.layout();
        let held = &mut self.scratch.held;
        for particle in self.state.resting.pieces.asleep() {
            let slot = layout.slot_of(particle as usize);
            let block = &mut particles.blocks_mut()[slot.block];
            let inverse_mass = block.inverse_mass(slot.lane);
            if inverse_mass > 0.0 {
                held.push((particle, inverse_mass));
                block.set_inverse_mass(slot.lane, 0.0);
                block.set_displacement(slot.lane, Vec3::ZERO);
            }
        }
        self.stats.sleeping_particles = held.len();
    }
}
