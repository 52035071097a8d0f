//! Finds the particles that each collider may touch in a tick, keeps that list valid during the tick, and records the
//! contacts.

mod carrying;
mod caught;
mod embedded;
mod margin;
mod pinned_faces;
mod requery;

use std::sync::Arc;

use bevy::math::{Vec3, bounding::BoundingSphere};

use super::{
    bodies::{Before, Body, BodyChange, Carriers},
    candidates::{Candidates, ContactPoint, ContactSettings, NarrowPhase, SavedCandidates, Touch},
    colliders::{ColliderShape, MovingCollider},
    edges::{ShapeCache, push_shape},
    friction::{Impulse, PushOut},
    particles::{ContactResult, ParticlesNearEdges, lane_motion, push_particles},
    triangles::{CoreMotion, ResumePoint, TrianglePush},
};
use crate::{
    cloth::{ClothParticles, Surface},
    hierarchy::{Probe, TopDownQuery},
    solver::SubStep,
};
use embedded::Embedding;
use margin::Margin;
use pinned_faces::is_sewn_on;

/// The penetrating area of triangles is measured in every fourth sub-step, in the last one, and until there is some. It
/// costs half as much as a push.
const MEASURED_EACH: u32 = 4;

/// A particle is pushed by six triangles, by at least a third of each.
const TRIANGLES_A_PUSH: f32 = 3.0;

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
    kept: SavedCandidates,
    /// The dynamic colliders.
    bodies: Vec<Body>,
    /// Memory of earlier ones.
    spare: Vec<Carriers>,
    before: Before,
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
        self.margin.begin(margin);
        self.requeries = 0;
    }

    /// Sets the radius of the particles (m), 0 by default. [`add`](Self::add) uses it to leave out triangles at pins.
    pub fn set_particle_radius(&mut self, particle_radius: f32) {
        self.particle_radius = particle_radius;
    }

    /// Returns the probe to search for this collider in the tick, and the narrow phase for it. Triangles reach
    /// `longest_edge` (m) from the particle that owns them.
    pub fn probe(
        &self,
        collider: &MovingCollider,
        settings: &ContactSettings,
        surface: &Surface,
        longest_edge: f32,
        cloth: &BoundingSphere,
    ) -> (Probe, NarrowPhase) {
        let spacing = surface.spacing().longest;
        let narrow_phase = settings
            .narrow_phase
            .of(collider, spacing, settings.particle_radius);
        let cover = match narrow_phase {
            NarrowPhase::Triangles => longest_edge,
            NarrowPhase::Auto | NarrowPhase::Particles => 0.0,
        };
        // Rounding of a position in each sub-step may add this to its displacement.
        let farthest = Vec3::from(cloth.center).length() + cloth.radius();
        let rounding = (farthest + collider.farthest_distance(cloth)) * 1.0e-5;
        let probe = collider.probe(
            self.margin.size() + cover + rounding,
            settings.particle_radius,
            cloth,
        );
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
        self.hold(id, collider, narrow_phase, 0, found, particles);
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
        self.embedding
            .find((id, collider), was_embedded, found, of, others);
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
        self.bodies
            .iter()
            .find(|body| body.id == id)
            .map(Body::change)
    }

    /// Adds a collider after a number of sub-steps.
    fn hold(
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
        let narrow_phase = match narrow_phase {
            // The triangles of what is inside would be pushed the nearest way.
            NarrowPhase::Triangles if is_embedded => NarrowPhase::Particles,
            other => other,
        };
        if self.bodies.iter().all(|body| body.id != id) {
            (self.bodies).extend(Body::of(id, collider, &mut self.spare));
        }
        if !self.margin.has_origin() {
            // Pushes that balance springs add up in a tick without a displacement, so it is measured from here.
            self.margin.remember(particles);
        }
        let layout = particles.layout();
        let is_sewn =
            |face: &[u32; 3]| is_sewn_on(face, collider, (passed, self.particle_radius), particles);
        // Cells are tested eight at a time, with pins or without.
        let is_by_cells = layout.rows > 1 && matches!(collider.shape, ColliderShape::Ball { .. });
        let may_be_sewn = !is_by_cells && particles.has_pinned();
        let is_left_out = |face: &[u32; 3]| may_be_sewn && is_sewn(face);
        let by_triangles = narrow_phase == NarrowPhase::Triangles;
        let triangles = by_triangles.then_some(&is_left_out);
        let of = self.candidates.add(found, &self.surface, layout, triangles);
        (self.embedding).note_places(id, &self.candidates.all[of.candidates.clone()]);
        match self.touches.binary_search_by_key(&id, |touch| touch.id) {
            Ok(at) => self.touches[at].of = of,
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
        let is_pushed = self.push_out(particles, settings, substep, others);
        if let Some(coming) = substep.next()
            && !self.bodies.is_empty()
        {
            self.attach_load(particles, coming);
        }
        is_pushed || has_carried
    }

    /// Pushes particles out of the colliders. Returns whether anything moved.
    fn push_out(
        &mut self,
        particles: &mut ClothParticles,
        settings: &ContactSettings,
        substep: SubStep,
        mut others: impl FnMut(&mut Vec<(usize, MovingCollider)>),
    ) -> bool {
        self.margin.begin_substep(substep.farthest_move);
        for touch in &mut self.touches {
            let travel = touch.collider.max_surface_travel(f32::INFINITY);
            touch.travelled += travel / substep.count as f32;
        }
        let mut is_pushed = false;
        let (mut next, mut from) = (0, ResumePoint::default());
        let (mut area, mut volume) = (0.0, 0.0);
        loop {
            if self.margin.is_outrun(particles) {
                others(&mut self.colliders);
                self.search(particles, settings, substep.index + 1);
            }
            let at = self.touches.partition_point(|touch| touch.id < next);
            if at == self.touches.len() {
                return is_pushed;
            }
            let (found, stopped) = self.push_out_of(at, from, particles, settings, substep);
            let given = self.share(at, &found, particles, substep);
            // Several triangles may push one particle.
            self.margin.note(found.farthest_push);
            is_pushed |= found.farthest_push > 0.0;
            let touch = &mut self.touches[at];
            touch.deepest = touch.deepest.max(found.deepest);
            let seconds = f64::from(particles.substep());
            touch.impulse += (given.linear / seconds).as_vec3();
            touch.angular_impulse += (given.angular / seconds).as_vec3();
            area += found.area;
            volume += found.volume;
            from = stopped.unwrap_or_default();
            if stopped.is_some() {
                next = touch.id;
                continue;
            }
            touch.area = touch.area.max(area);
            touch.volume = touch.volume.max(volume);
            (area, volume) = (0.0, 0.0);
            let Some(after) = touch.id.checked_add(1) else {
                return is_pushed;
            };
            next = after;
        }
    }

    /// Pushes particles out of one collider. Returns what it did, and where to go on if candidates may be missing.
    fn push_out_of(
        &mut self,
        at: usize,
        from: ResumePoint,
        particles: &mut ClothParticles,
        settings: &ContactSettings,
        substep: SubStep,
    ) -> (ContactResult, Option<ResumePoint>) {
        let (touch, margin) = (&self.touches[at], &self.margin);
        let count = self.candidates.all.len();
        let Candidates {
            all, blocks, helds, ..
        } = &mut self.candidates;
        let collider = &touch.collider;
        let first = touch.of.blocks.start;
        let contacts = &mut blocks[touch.of.blocks.clone()];
        if self.bodies.iter().any(|body| body.id == touch.id) {
            let blocks = contacts.iter().map(|contact| contact.block as usize);
            let embedded = self.embedding.blocks(touch.id);
            self.before.save(blocks.chain(embedded), particles);
        }
        let has_edges = collider.shape.has_edges();
        // The guard measures the cloth.
        let odometer = if has_edges { 0.0 } else { margin.odometer() } + touch.travelled;
        let motion = collider.in_substep(substep);
        let travel = motion.slide.length() + motion.swing;
        let shares = match touch.narrow_phase {
            NarrowPhase::Triangles if !has_edges => TRIANGLES_A_PUSH,
            _ => 1.0,
        };
        let push_out = PushOut::new(particles.substep(), travel, shares);
        let lanes = lane_motion(&motion, settings, push_out, odometer);
        self.embedding.hide(touch.id, particles);
        let (found, stopped) = match touch.narrow_phase {
            _ if has_edges => {
                self.shapes.reserve(count);
                let by_triangles = touch.narrow_phase == NarrowPhase::Triangles;
                let of = (touch.id, &collider.shape, self.surface.len());
                let of = (by_triangles || collider.shape.is_geometry()).then_some(of);
                let limit = collider.max_surface_travel(f32::INFINITY) + margin.size();
                let travelled = [touch.travelled, limit];
                (self.shapes.guard).measure(particles, margin.origin(), contacts, travelled);
                let known = self.shapes.of(touch.of.candidates.clone(), of);
                let mut pushing = ParticlesNearEdges {
                    candidates: &all[touch.of.candidates.clone()],
                    contacts,
                    first,
                    motion,
                    settings,
                    lanes: &lanes,
                };
                let edges = by_triangles.then_some(&*self.surface);
                (push_shape(particles, &mut pushing, known, edges), None)
            }
            NarrowPhase::Triangles => {
                let is_measured = touch.area == 0.0
                    || (substep.index + 1).is_multiple_of(MEASURED_EACH)
                    || substep.index + 1 == substep.count;
                let mut pushed = TrianglePush::new(
                    &all[touch.of.candidates.clone()],
                    (contacts, first),
                    &mut helds[touch.of.helds.clone()],
                    (self.surface.fans(), self.surface.max_faces() as f32),
                    [margin.left(), margin.moved_now()],
                    is_measured,
                );
                let core = CoreMotion::new(motion, settings);
                let stopped = pushed.push(particles, (&core, &lanes), from);
                (pushed.found, stopped)
            }
            NarrowPhase::Auto | NarrowPhase::Particles => {
                let of = (&motion, settings);
                let found = push_particles(particles, contacts, (&mut [], 0), of, &lanes);
                (found, None)
            }
        };
        let of = (touch.id, &motion);
        let embedded = self.embedding.push(particles, blocks, of, settings);
        (found.and(&embedded), stopped)
    }

    /// Gives a body its share of the pushes, if the collider is one. Returns the impulse on the collider.
    fn share(
        &mut self,
        at: usize,
        found: &ContactResult,
        particles: &mut ClothParticles,
        substep: SubStep,
    ) -> Impulse {
        let touch = &mut self.touches[at];
        let mut given = found.given;
        let body = self.bodies.iter_mut().find(|body| body.id == touch.id);
        if let Some(body) = body
            && found.farthest_push > 0.0
        {
            let mut moving = touch.collider.clone();
            let [kept, gone] = body.share(&self.before, particles, &mut moving, substep);
            given.scale(f64::from(kept));
            touch.travelled += gone;
            self.margin.deviate(body.deviation(&moving, substep.end()));
            let touches = std::slice::from_mut(touch);
            send_on(touches, &mut self.colliders, body.id, &moving);
        }
        given
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
