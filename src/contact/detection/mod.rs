//! Finds the particles that each collider may touch in a tick, keeps that list valid during the tick, and records the
//! contacts.

mod carrying;
mod caught;
mod embedded;
mod margin;
mod pieces;
mod pinned_faces;
mod push_out;
mod requery;
mod standing;

use std::sync::Arc;

use bevy::math::{Vec3, bounding::BoundingSphere};

use super::{
    bodies::{Body, BodyChange, Carriers, StandingResponse, Supports},
    candidates::{
        Candidates, ContactPoint, ContactSettings, NarrowPhase, PushedParticles, SavedCandidates,
        TestedFaces, Touch,
    },
    colliders::{ColliderShape, MovingCollider},
    edges::ShapeCache,
};
use crate::{
    cloth::{Block, ClothParticles, Lanes, Surface},
    hierarchy::{Probe, TopDownQuery},
    solver::SubStep,
};
use embedded::Embedding;
use margin::Margin;
use pinned_faces::is_sewn_on;

/// The broad phase during a tick: the particles that each collider may touch.
///
/// These are the particles within a *margin* of the collider, along its whole path. None is missed while no particle
/// has moved farther than the margin since the search. This is checked in each sub-step: if one has, all colliders
/// search again from the current positions.
#[derive(Debug, Default, Clone)]
pub struct Detection {
    /// Sorted by ID, so that the result does not depend on when they were found.
    touches: Vec<Touch>,
    candidates: Candidates,
    embedding: Embedding,
    /// All colliders searched for, touching or not, to search again.
    colliders: Vec<(usize, MovingCollider)>,
    surface: Arc<Surface>,
    /// Radius of the particles at the beginning of a tick (m).
    particle_radius: f32,
    margin: Margin,
    requeries: u32,
    found: TopDownQuery,
    saved: SavedCandidates,
    /// The dynamic colliders.
    bodies: Vec<Body>,
    /// Memory of earlier ones.
    spare: Vec<Carriers>,
    /// Blocks of particles before a body's push.
    before: Vec<(usize, Block)>,
    supports: Supports,
    shapes: ShapeCache,
}

impl Detection {
    /// Begins a tick of a surface's particles. None is expected to move farther than `margin` (m).
    pub fn begin(&mut self, surface: &Arc<Surface>, margin: f32) {
        if !Arc::ptr_eq(&self.surface, surface) {
            self.surface = surface.clone();
            self.shapes.memories.clear();
        }
        self.shapes.memories.begin();
        self.touches.clear();
        self.candidates.clear();
        self.embedding.clear();
        self.shapes.clear();
        self.colliders.clear();
        (self.spare).extend(self.bodies.drain(..).map(|body| body.carriers));
        self.supports.clear();
        self.margin.begin(margin);
        self.requeries = 0;
    }

    /// Sets the radius of the particles (m), 0 by default. [`add`](Self::add) uses it to leave out triangles at pins.
    pub fn set_particle_radius(&mut self, particle_radius: f32) {
        self.particle_radius = particle_radius;
    }

    /// Sets factors of μ, by the cloth's blocks; none by default.
    pub(crate) fn set_grips(&mut self, grips: &Arc<[Lanes]>) {
        if !Arc::ptr_eq(&self.candidates.grips, grips) {
            self.candidates.grips = grips.clone();
        }
    }

    /// Returns the probe to search for this collider in the tick, and the narrow phase for it: `Auto` where that depends on the
    /// triangles near it. Triangles reach
    /// `longest_edge` (m) from the particle that owns them.
    pub fn probe(
        &self,
        collider: &MovingCollider,
        settings: &ContactSettings,
        surface: &Surface,
        longest_edge: f32,
        cloth: &BoundingSphere,
    ) -> (Probe, NarrowPhase) {
        let margin = self.margin.size;
        Self::probe_within(margin, collider, settings, surface, longest_edge, cloth)
    }

    /// The same with a given margin (m).
    pub(crate) fn probe_within(
        margin: f32,
        collider: &MovingCollider,
        settings: &ContactSettings,
        surface: &Surface,
        longest_edge: f32,
        cloth: &BoundingSphere,
    ) -> (Probe, NarrowPhase) {
        let particle_radius = settings.particle_radius;
        let narrow_phase = (settings.narrow_phase).of(collider, surface, particle_radius);
        let cover = match narrow_phase {
            NarrowPhase::Triangles | NarrowPhase::Auto => longest_edge,
            NarrowPhase::Particles => 0.0,
        };
        // Rounding of a position in each sub-step may add this to its displacement.
        let farthest = Vec3::from(cloth.center).length() + cloth.radius();
        let rounding = (farthest + collider.farthest_distance(cloth)) * 1.0e-5;
        let probe = collider.probe(margin + cover + rounding, particle_radius, cloth);
        (probe, narrow_phase)
    }

    /// Adds the particles that the search has found for a collider, whose caller's ID is `id`. Call it for each
    /// collider, even if none were found, because other colliders may push particles to it. `particles` are those at
    /// the beginning of the tick.
    ///
    /// Triangles with a corner pinned inside the collider, or within a [particle's radius](Self::set_particle_radius)
    /// of it, are not tested, such as those of a flag along its pole. Neither are the other triangles of the same
    /// owner.
    pub fn add(
        &mut self,
        id: usize,
        collider: &MovingCollider,
        narrow_phase: NarrowPhase,
        found: &[u32],
        particles: &ClothParticles,
    ) {
        // Most callers count upwards.
        let is_new = self.colliders.last().is_none_or(|(last, _)| *last < id);
        if is_new || self.colliders.iter().all(|(known, _)| *known != id) {
            self.colliders.push((id, collider.clone()));
        }
        self.list(id, collider, narrow_phase, 0, found, particles);
    }

    /// Finds cloth that begins the tick deep inside a collider, among the particles that the search has found for it:
    /// before they are [added](Self::add). Only for a collider that did not touch it in the last tick, or if cloth
    /// `was_embedded` in it then. `others` are all colliders near.
    pub fn embed<'a>(
        &mut self,
        id: usize,
        collider: &MovingCollider,
        was_embedded: bool,
        found: &[u32],
        particles: &ClothParticles,
        others: impl Iterator<Item = &'a MovingCollider> + Clone,
    ) {
        let of = (&*self.surface, particles, self.particle_radius);
        (self.embedding).find((id, collider), was_embedded, found, of, others);
    }

    /// Whether cloth is embedded in a collider in this tick.
    pub(crate) fn is_embedded(&self, id: usize) -> bool {
        self.embedding.blocks(id).len() > 0
    }

    /// Depth of the deepest particle that is embedded in this tick (m).
    pub(crate) fn embedded(&self) -> f32 {
        self.embedding.deepest()
    }

    /// The change of a collider's motion by the cloth so far, if it is dynamic and was near.
    pub fn body_change(&self, id: usize) -> Option<BodyChange> {
        let body = self.bodies.iter().find(|body| body.id == id);
        body.map(|body| body.change)
    }

    /// The part of that change by what the body stands on.
    pub(crate) fn body_held(&self, id: usize) -> BodyChange {
        let body = self.bodies.iter().find(|body| body.id == id);
        body.map_or_else(BodyChange::default, |body| body.held)
    }

    /// Adds a collider after a number of sub-steps.
    fn list(
        &mut self,
        id: usize,
        collider: &MovingCollider,
        narrow_phase: NarrowPhase,
        passed: u32,
        found: &[u32],
        particles: &ClothParticles,
    ) {
        if found.is_empty() {
            return;
        }
        let is_embedded = self.is_embedded(id);
        let pushed = match (narrow_phase, collider.shape.radius()) {
            (_, None) => PushedParticles::All,
            (NarrowPhase::Auto, Some(radius)) => {
                PushedParticles::Fine(NarrowPhase::widest_fine(radius))
            }
            (_, Some(_)) => PushedParticles::None,
        };
        let is_coarse = |of: &u32| match pushed {
            PushedParticles::Fine(widest) => self.surface.face_widths()[*of as usize] > widest,
            PushedParticles::All | PushedParticles::None => true,
        };
        let narrow_phase = match narrow_phase {
            // The triangles of what is inside would be pushed the nearest way.
            _ if is_embedded => NarrowPhase::Particles,
            NarrowPhase::Auto if found.iter().any(is_coarse) => NarrowPhase::Triangles,
            NarrowPhase::Auto => NarrowPhase::Particles,
            other => other,
        };
        if self.bodies.iter().all(|body| body.id != id) {
            (self.bodies).extend(Body::of(id, collider, &mut self.spare));
        }
        if !self.margin.has_origin {
            // Pushes that balance springs add up in a tick without a displacement, so it is measured from here.
            self.margin.remember(particles);
        }
        let layout = particles.layout();
        let is_sewn =
            |face: &[u32; 3]| is_sewn_on(face, collider, (passed, self.particle_radius), particles);
        // Cells are tested eight at a time, with pins or without.
        let is_by_cells = layout.has_cells && matches!(collider.shape, ColliderShape::Ball { .. });
        let may_be_sewn = !is_by_cells && particles.has_pinned();
        let is_left_out = |face: &[u32; 3]| may_be_sewn && is_sewn(face);
        let by_triangles = narrow_phase == NarrowPhase::Triangles;
        let faces = TestedFaces {
            is_left_out,
            pushed,
        };
        let faces = by_triangles.then_some(&faces);
        let of = self.candidates.add(found, &self.surface, layout, faces);
        (self.embedding).note_places(id, &self.candidates.all[of.candidates.clone()]);
        match self.touches.binary_search_by_key(&id, |touch| touch.id) {
            Ok(at) => (self.touches[at].of, self.touches[at].narrow_phase) = (of, narrow_phase),
            Err(at) => self.touches.insert(
                at,
                Touch {
                    id,
                    collider: collider.clone(),
                    narrow_phase,
                    deepest: 0.0,
                    area: 0.0,
                    volume: 0.0,
                    impulse: Vec3::ZERO,
                    angular_impulse: Vec3::ZERO,
                    of,
                    travelled: 0.0,
                },
            ),
        }
    }

    /// Pushes particles out of the colliders at the end of a sub-step. Returns whether anything moved.
    ///
    /// If particles may have moved farther than the margin, by themselves or by a push, all colliders search again
    /// first. `others` then adds colliders, with their IDs, that were never [added](Self::add) because they seemed too
    /// far away.
    pub fn respond(
        &mut self,
        particles: &mut ClothParticles,
        settings: &ContactSettings,
        substep: SubStep,
        others: impl FnMut(&mut Vec<(usize, MovingCollider)>),
    ) -> bool {
        let has_carried = self.detach_load(particles, substep);
        self.follow_rolling(particles, substep.end());
        let has_stood = self.stand(particles, settings, substep, StandingResponse::KeepOff);
        let is_pushed = self.push_out(particles, settings, substep, others);
        self.stand(particles, settings, substep, StandingResponse::Rub);
        if let Some(coming) = substep.next()
            && !self.bodies.is_empty()
        {
            self.attach_load(particles, coming);
        }
        is_pushed || has_carried || has_stood
    }

    /// The colliders that may touch.
    pub fn touches(&self) -> &[Touch] {
        &self.touches
    }

    /// The particles near a collider.
    pub fn points(&self, touch: &Touch) -> impl ExactSizeIterator<Item = ContactPoint> + '_ {
        self.candidates.all[touch.of.candidates.clone()]
            .iter()
            .map(|candidate| ContactPoint {
                particle: candidate.particle,
                depth: self.candidates.depth_of(candidate),
            })
    }

    /// Number of searches repeated in the tick because particles moved farther than the margin.
    pub fn requeries(&self) -> u32 {
        self.requeries
    }
}

/// Gives a collider a new motion.
fn send_on(
    touches: &mut [Touch],
    colliders: &mut [(usize, MovingCollider)],
    id: usize,
    moving: &MovingCollider,
) {
    for touch in touches.iter_mut().filter(|touch| touch.id == id) {
        touch.collider.clone_from(moving);
    }
    for (_, collider) in colliders.iter_mut().filter(|(known, _)| *known == id) {
        collider.clone_from(moving);
    }
}
