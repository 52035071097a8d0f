//! Which particles each collider may touch in a tick, kept true while the tick goes on, and what came of it.

use std::sync::Arc;

use bevy::math::{Vec3, bounding::BoundingSphere};

use super::{
    MovingCollider, NarrowPhase,
    faces::{ResumePoint, SubstepMotion, push_triangles},
    particle::push_particles,
    shape_cache::{ShapeCache, push_shape},
    touch::{Candidate, ContactPoint, ContactSettings, Fans, Touch},
};
use crate::{
    cloth::{ClothParticles, Surface},
    hierarchy::{Probe, TopDownQuery},
    solver::SubStep,
};

/// How often a sub-step measures how far particles have moved, before it searches again.
const MAX_MEASURED: u32 = 2;

/// Which particles each collider may touch in a tick.
///
/// They are those that come within the collider, all along its way, as far as a *margin*. Nothing is missed while no
/// particle has moved farther than the margin since: that is watched from sub-step to sub-step, and if one has, all
/// particles are searched again from where they are then.
#[derive(Debug, Default, Clone)]
pub struct Detection {
    /// In the order of their numbers, so that the result is the same whenever they were found.
    touches: Vec<Touch>,
    candidates: Vec<Candidate>,
    /// All that were searched for, touching or not, and among what: to search again.
    colliders: Vec<(usize, MovingCollider)>,
    surface: Arc<Surface>,
    fans: Fans,
    /// How far a particle may move before the candidates are searched for again (m).
    margin: f32,
    /// How far one may have moved since they were (m): as the largest moves and pushes add up, or as measured.
    moved: f32,
    /// The particles as they were then, if anything was searched for.
    origin: ClothParticles,
    has_origin: bool,
    /// How often it was measured in this sub-step.
    measured: u32,
    /// How far of that in this sub-step: the way that is swept lies so far behind (m).
    moved_now: f32,
    requeries: u32,
    found: TopDownQuery,
    known: Vec<(usize, ContactPoint)>,
    shapes: ShapeCache,
}

impl Detection {
    /// Begins a tick of a surface's particles, none of which is expected to move farther than `margin` (m).
    pub fn begin(&mut self, surface: &Arc<Surface>, margin: f32) {
        if !Arc::ptr_eq(&self.surface, surface) {
            self.surface = surface.clone();
            self.fans.max_faces = surface.max_faces() as f32;
        }
        self.touches.clear();
        self.candidates.clear();
        self.shapes.clear();
        self.fans.clear();
        self.colliders.clear();
        self.margin = margin;
        (self.moved, self.moved_now) = (0.0, 0.0);
        self.has_origin = false;
        self.requeries = 0;
    }

    /// What to search for, for this collider to be tested in the tick, and against what it then is tested. Triangles
    /// reach `longest_edge` (m) from the particle that stands for them.
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
        // What each sub-step's rounding of a position may add to its move.
        let farthest = Vec3::from(cloth.center).length() + cloth.radius();
        let rounding = (farthest + collider.farthest_distance(cloth)) * 1.0e-5;
        let probe = collider.probe(
            self.margin + cover + rounding,
            settings.particle_radius,
            cloth,
        );
        (probe, narrow_phase)
    }

    /// Takes over which particles the search has found for a collider, which is the caller's number `id`. To be called
    /// for each collider, whether any were found or not: others may yet push some to it.
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
        self.hold(id, collider, narrow_phase, found, particles);
    }

    fn hold(
        &mut self,
        id: usize,
        collider: &MovingCollider,
        narrow_phase: NarrowPhase,
        found: &[u32],
        particles: &ClothParticles,
    ) {
        if found.is_empty() {
            return;
        }
        let first = self.candidates.len();
        let layout = particles.layout();
        let by_triangles = narrow_phase == NarrowPhase::Triangles;
        for &particle in found {
            let [corners, faces] = if by_triangles {
                self.fans.add(&self.surface, layout, particle)
            } else {
                [[0; 2]; 2]
            };
            self.candidates.push(Candidate {
                particle,
                slot: layout.slot_of(particle as usize),
                corners,
                faces,
                area: self.surface.area_of(particle as usize),
                depth: f32::NEG_INFINITY,
            });
        }
        // In the order of the cloth, whatever the search's: so the result is the same whichever it is.
        self.candidates[first..].sort_unstable_by_key(|candidate| candidate.particle);
        let candidates = first..self.candidates.len();
        match self.touches.binary_search_by_key(&id, |touch| touch.id) {
            Ok(at) => self.touches[at].candidates = candidates,
            Err(at) => self.touches.insert(
                at,
                Touch {
                    id,
                    collider: collider.clone(),
                    narrow_phase,
                    deepest: 0.0,
                    area: 0.0,
                    volume: 0.0,
                    candidates,
                },
            ),
        }
    }

    /// Begins the tick again, from the same particles: for one that is done again.
    pub fn restart(&mut self) {
        self.shapes.clear();
        for touch in &mut self.touches {
            (touch.deepest, touch.area, touch.volume) = (0.0, 0.0, 0.0);
        }
        for candidate in &mut self.candidates {
            candidate.depth = f32::NEG_INFINITY;
        }
        // What was searched for on the way was found where the particles were then.
        self.moved = if self.requeries > 0 {
            f32::INFINITY
        } else {
            0.0
        };
    }

    fn remember(&mut self, particles: &ClothParticles) {
        self.origin.copy_from(particles);
        self.has_origin = true;
    }

    /// Whether particles have moved so far that candidates may be missing. The sum of all moves says so first; it counts
    /// every jitter, so what it says is measured.
    fn is_outrun(&mut self, particles: &ClothParticles) -> bool {
        // NaN is no less.
        let is_beyond = |moved: f32, margin: f32| moved > margin || moved.is_nan();
        if !is_beyond(self.moved, self.margin) {
            return false;
        }
        // Searching again widens the margin: cheaper than to measure for every push.
        if self.has_origin && self.measured < MAX_MEASURED {
            self.measured += 1;
            self.moved = particles.farthest_from(&self.origin);
        }
        is_beyond(self.moved, self.margin)
    }

    /// Searches for the candidates of all colliders again, among the particles as they are.
    fn search(&mut self, particles: &ClothParticles, settings: &ContactSettings) {
        if self.colliders.is_empty() {
            // There is nothing to miss.
            self.margin = f32::INFINITY;
            return;
        }
        self.requeries += 1;
        // Twice as much as did not suffice: a tick has few of these, however wild it is.
        let finite = |length: f32| if length.is_finite() { length } else { 0.0 };
        let moved_now = finite(self.moved_now);
        self.margin = 2.0 * finite(self.moved).max(moved_now).max(self.margin);
        // The way of this sub-step lies behind.
        self.moved = moved_now;
        self.remember(particles);
        self.known.clear();
        for touch in &mut self.touches {
            let candidates = self.candidates[touch.candidates.clone()].iter();
            let looked_at = candidates.filter(|candidate| candidate.depth > f32::NEG_INFINITY);
            self.known.extend(looked_at.map(|candidate| {
                (
                    touch.id,
                    ContactPoint {
                        particle: candidate.particle,
                        depth: candidate.depth,
                    },
                )
            }));
            touch.candidates = 0..0;
        }
        self.candidates.clear();
        self.shapes.clear();
        self.fans.clear();
        let cloth = particles.bounding_sphere();
        let longest_edge = particles.longest_face_reach(&self.surface);
        let mut found = std::mem::take(&mut self.found);
        let colliders = std::mem::take(&mut self.colliders);
        for (id, collider) in &colliders {
            let (probe, narrow_phase) =
                self.probe(collider, settings, &self.surface, longest_edge, &cloth);
            found.clear();
            if probe
                .core
                .may_reach(cloth.center.into(), cloth.radius() + probe.reach() as f32)
            {
                found.scan(particles, &probe);
            }
            // What was looked at stays, so that nothing that touched is forgotten.
            // In the order of the touches' numbers.
            let first = self.known.partition_point(|(known, _)| known < id);
            let known = self.known[first..]
                .iter()
                .take_while(|(known, _)| known == id)
                .map(|(_, point)| point.particle);
            let mut all: Vec<u32> = known.chain(found.candidates().iter().copied()).collect();
            all.sort_unstable();
            all.dedup();
            self.hold(*id, collider, narrow_phase, &all, particles);
        }
        self.colliders = colliders;
        self.found = found;
        for &(id, point) in &self.known {
            let Ok(at) = self.touches.binary_search_by_key(&id, |touch| touch.id) else {
                continue;
            };
            let touch = &self.touches[at];
            let candidates = &mut self.candidates[touch.candidates.clone()];
            if let Ok(at) =
                candidates.binary_search_by_key(&point.particle, |candidate| candidate.particle)
            {
                candidates[at].depth = point.depth;
            }
        }
    }

    /// Pushes what is inside of a collider out, at the end of a sub-step. Returns whether anything moved.
    ///
    /// Where particles may have moved farther than the margin, by themselves or by a push, all are searched again before
    /// anything else is done; `others` then adds the colliders with their numbers that were never [added](Self::add), as
    /// they seemed to be too far away.
    pub fn respond(
        &mut self,
        particles: &mut ClothParticles,
        settings: &ContactSettings,
        substep: SubStep,
        mut others: impl FnMut(&mut Vec<(usize, MovingCollider)>),
    ) -> bool {
        self.moved += substep.farthest_move;
        self.shapes.travelled += substep.farthest_move;
        self.moved_now = substep.farthest_move;
        self.measured = 0;
        let mut is_pushed = false;
        let (mut next, mut from) = (0, ResumePoint::default());
        let (mut area, mut volume) = (0.0, 0.0);
        loop {
            if self.is_outrun(particles) {
                others(&mut self.colliders);
                self.search(particles, settings);
            }
            let at = self.touches.partition_point(|touch| touch.id < next);
            let Some(touch) = self.touches.get_mut(at) else {
                return is_pushed;
            };
            let count = self.candidates.len();
            let candidates = &mut self.candidates[touch.candidates.clone()];
            let collider = &touch.collider;
            let (found, stopped) = match touch.narrow_phase {
                _ if collider.shape.has_edges() => {
                    self.shapes.make_room(count);
                    let known = self.shapes.of(touch.candidates.clone());
                    let edges = (touch.narrow_phase == NarrowPhase::Triangles)
                        .then(|| (&self.fans, self.surface.spacing().longest));
                    let found = push_shape(
                        particles, candidates, known, edges, collider, settings, substep,
                    );
                    (found, None)
                }
                NarrowPhase::Triangles => {
                    let room = self.margin - self.moved;
                    let motion = SubstepMotion::new(collider, settings, substep);
                    push_triangles(particles, candidates, &self.fans, &motion, from, room)
                }
                NarrowPhase::Auto | NarrowPhase::Particles => (
                    push_particles(particles, candidates, collider, settings, substep),
                    None,
                ),
            };
            // One may be pushed by several.
            self.moved += found.farthest_push;
            self.moved_now += found.farthest_push;
            self.shapes.travelled += found.farthest_push;
            is_pushed |= found.farthest_push > 0.0;
            touch.deepest = touch.deepest.max(found.deepest);
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

    /// The colliders that may touch.
    pub fn touches(&self) -> &[Touch] {
        &self.touches
    }

    /// The particles near a collider.
    pub fn points(&self, touch: &Touch) -> impl ExactSizeIterator<Item = ContactPoint> + '_ {
        self.candidates[touch.candidates.clone()]
            .iter()
            .map(|candidate| ContactPoint {
                particle: candidate.particle,
                depth: candidate.depth,
            })
    }

    /// How often in the tick particles moved farther than the margin.
    pub fn requeries(&self) -> u32 {
        self.requeries
    }
}
