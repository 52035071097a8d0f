//! Cloth that begins a tick deep inside a collider, which appeared or was teleported there.

use std::ops::Range;

use bevy::math::Vec3;

use super::pieces::Pieces;
use crate::{
    cloth::{ClothParticles, LANES, Slot, Surface},
    contact::{
        candidates::{Candidate, ContactBlock, ContactSettings},
        colliders::{ColliderShape, ColliderSubstep, MovingCollider},
        particles::ContactResult,
    },
};

/// A piece is looked at if its deepest particle's centre is so deep inside, in spacings.
const DEEP: f32 = 0.25;

/// Speed on a common way (m/s), and the largest acceleration towards it (m/s²): against taut cloth it is a force, so it
/// stretches nothing far.
const SPEED: f32 = 0.18;
const ACCELERATION: f32 = 400.0;

/// Time in which the motion inside decays to 1/e (s).
const SLOWED_FOR: f32 = 0.1;

/// In place of a lane, before the candidates are known.
const NOWHERE: u32 = u32::MAX;

/// The particles that leave colliders by another way than the nearest.
///
/// The nearest ways out of a ball in a curtain lead to both of its sides. They would stretch the cloth without end, and it
/// would whip. So all of a connected piece goes one way: along its mean normal or against it, or along the mean of the
/// nearest ways out, whichever is shortest for its deepest particle and ends inside no other collider. A piece that finds none, or that
/// hangs from a pin inside, is left alone.
#[derive(Debug, Default, Clone)]
pub(crate) struct Embedding {
    all: Vec<Embedded>,
    /// Depth of the deepest of them (m).
    deepest: f32,
    /// Memory of [`find`](Self::find).
    pieces: Pieces,
}

/// A particle with its own way out of a collider.
#[derive(Debug, Clone, Copy)]
struct Embedded {
    /// The caller's ID of the collider.
    id: usize,
    particle: u32,
    slot: Slot,
    /// Its lane, counted through the contact blocks.
    place: u32,
    /// While it is hidden (1/kg).
    inverse_mass: f32,
    /// Direction of its way, in the cloth's frame; `None` to leave it alone.
    direction: Option<Vec3>,
}

impl Embedding {
    /// Begins a tick.
    pub fn clear(&mut self) {
        self.all.clear();
        self.deepest = 0.0;
    }

    /// Finds the particles that leave a collider by another way than the nearest, among those found near it as the tick
    /// begins. `others` are all colliders near. Call it only for a collider that it did not touch in the last tick, or if it
    /// `was_embedded`: what touches deeper is squeezed.
    ///
    /// They are in pieces that their nearest ways out would tear, or push into another collider.
    pub fn find<'a>(
        &mut self,
        (id, collider): (usize, &MovingCollider),
        was_embedded: bool,
        found: &[u32],
        (surface, particles, particle_radius): (&Surface, &ClothParticles, f32),
        others: impl Iterator<Item = &'a MovingCollider> + Clone,
    ) {
        let deep = particle_radius + DEEP * surface.spacing().shortest;
        let begins_at = if was_embedded { 0.0 } else { deep };
        // Only a half-space has one way out for all.
        if collider.shape == ColliderShape::HalfSpace
            || (self.pieces).collect(collider, found, particles, particle_radius) <= begins_at
        {
            return;
        }
        let others = others.filter(|other| *other != collider);
        (self.pieces).find_ways(collider, surface, particles, particle_radius, others);
        let layout = particles.layout();
        for (inside, direction) in self.pieces.torn() {
            self.deepest = self.deepest.max(inside.out.length());
            self.all.push(Embedded {
                id,
                particle: inside.particle,
                place: NOWHERE,
                slot: layout.slot_of(inside.particle as usize),
                inverse_mass: 0.0,
                direction,
            });
        }
    }

    /// Depth of the deepest of them as the tick began (m); 0 if there is none.
    pub fn deepest(&self) -> f32 {
        self.deepest
    }

    /// The range of those that do so for one collider.
    fn range(&self, id: usize) -> Range<usize> {
        // Callers count upwards.
        let before = |id: usize| self.all.partition_point(|one| one.id < id);
        before(id)..before(id.saturating_add(1))
    }

    /// Blocks of the particles that leave a collider by another way than the nearest.
    pub fn blocks(&self, id: usize) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.all[self.range(id)].iter().map(|one| one.slot.block)
    }

    /// Notes where the candidates are among the contact blocks.
    pub fn note_places(&mut self, id: usize, candidates: &[Candidate]) {
        let own = self.range(id);
        for one in &mut self.all[own] {
            let key = one.particle;
            let at = candidates.binary_search_by_key(&key, |candidate| candidate.particle);
            one.place = at.map_or(NOWHERE, |at| candidates[at].place);
        }
    }

    /// Holds them in place while the collider pushes others, until [`push`](Self::push).
    pub fn hide(&mut self, id: usize, particles: &mut ClothParticles) {
        let own = self.range(id);
        for one in &mut self.all[own] {
            let block = &mut particles.blocks_mut()[one.slot.block];
            one.inverse_mass = block.inverse_mass(one.slot.lane);
            block.set_inverse_mass(one.slot.lane, 0.0);
        }
    }

    /// Moves them on along their ways. `contacts` are all blocks of candidates.
    pub fn push(
        &self,
        particles: &mut ClothParticles,
        contacts: &mut [ContactBlock],
        (id, of): (usize, &ColliderSubstep),
        settings: &ContactSettings,
    ) -> ContactResult {
        let mut found = ContactResult::default();
        let seconds = particles.substep();
        let (fastest, most) = (SPEED * seconds, ACCELERATION * seconds * seconds);
        for one in &self.all[self.range(id)] {
            let block = &mut particles.blocks_mut()[one.slot.block];
            let lane = one.slot.lane;
            block.set_inverse_mass(lane, one.inverse_mass);
            let (place, displacement) = (block.position(lane), block.displacement(lane));
            let nearest = of.nearest(place);
            let depth = settings.particle_radius - nearest.distance;
            let in_contacts = one.place as usize;
            if let Some(contact) = contacts.get_mut(in_contacts / LANES) {
                let known = &mut contact.depth[in_contacts % LANES];
                *known = known.max(depth);
            }
            if depth.is_nan() || depth <= 0.0 {
                continue;
            }
            found.deepest = found.deepest.max(depth);
            let Some(direction) = one.direction else {
                continue;
            };
            let relative = displacement - of.surface_motion(place);
            let slowed = relative * (1.0 - seconds / (seconds + SLOWED_FOR));
            let faster = (fastest.min(depth) - slowed.dot(direction)).clamp(0.0, most);
            let push = slowed + direction * faster - relative;
            let pushed = place + push;
            block.set_position(lane, pushed);
            block.set_displacement(lane, displacement + push);
            (found.given).add(pushed - of.origin, push, one.inverse_mass);
            found.farthest_push = found.farthest_push.max(push.length());
        }
        found
    }
}
