//! When candidates may be missing, and how they are searched for again.

use bevy::math::Vec3;

use super::{Detection, send_on};
use crate::{
    cloth::ClothParticles,
    contact::{candidates::Ranges, touch::ContactSettings},
    solver::SubStep,
};

/// How often a sub-step measures how far particles have moved, before it searches again.
const MAX_MEASURED: u32 = 2;

impl Detection {
    /// Begins the tick again, from the same particles: for one that is done again.
    pub fn restart(&mut self) {
        self.shapes.clear();
        self.shapes.memories.restart();
        for touch in &mut self.touches {
            (touch.deepest, touch.area, touch.volume) = (0.0, 0.0, 0.0);
            (touch.impulse, touch.angular_impulse) = (Vec3::ZERO, Vec3::ZERO);
            touch.traveled = 0.0;
        }
        self.candidates.restart();
        self.odometer = 0.0;
        for body in &mut self.bodies {
            let way = body.restart();
            send_on(&mut self.touches, &mut self.colliders, body.id, &way);
        }
        // What was searched for on the way was found where the particles were then.
        self.moved = if self.requeries > 0 {
            f32::INFINITY
        } else {
            0.0
        };
    }

    pub(super) fn remember(&mut self, particles: &ClothParticles) {
        self.origin.copy_places_from(particles);
        self.has_origin = true;
    }

    /// Whether particles have moved so far that candidates may be missing. The sum of all moves says so first; it counts
    /// every jitter, so what it says is measured.
    pub(super) fn is_outrun(&mut self, particles: &ClothParticles) -> bool {
        // NaN is no less.
        let is_beyond = |moved: f32, margin: f32| moved > margin || moved.is_nan();
        if !is_beyond(self.moved + self.deviation, self.margin) {
            return false;
        }
        // Searching again widens the margin: cheaper than to measure for every push.
        if self.has_origin && self.measured < MAX_MEASURED {
            self.measured += 1;
            self.moved = particles.farthest_from(&self.origin);
        }
        is_beyond(self.moved + self.deviation, self.margin)
    }

    /// Searches for the candidates of all colliders again, among the particles as they are when so many sub-steps
    /// have passed.
    pub(super) fn search(
        &mut self,
        particles: &ClothParticles,
        settings: &ContactSettings,
        passed: u32,
    ) {
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
        self.deviation = 0.0;
        for body in &mut self.bodies {
            if let Some((_, way)) = self.colliders.iter().find(|(id, _)| *id == body.id) {
                body.set_searched(way);
            }
        }
        self.kept.take(&self.touches, &self.candidates);
        for touch in &mut self.touches {
            touch.of = Ranges::default();
        }
        self.candidates.clear();
        self.shapes.clear();
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
            let found = found.candidates().iter().copied();
            let mut all: Vec<u32> = self.kept.particles(*id).chain(found).collect();
            all.sort_unstable();
            all.dedup();
            self.hold(*id, collider, narrow_phase, passed, &all, particles);
        }
        self.colliders = colliders;
        self.found = found;
        self.kept.give_back(&self.touches, &mut self.candidates);
    }

    /// Takes into account that something else has pushed particles, by at most this far (m).
    pub fn note_push(&mut self, farthest: f32) {
        self.moved += farthest;
        self.moved_now += farthest;
        self.odometer += farthest;
        self.shapes.travelled += farthest;
    }

    /// Forgets all that is known of edges.
    #[cfg(test)]
    pub(in crate::contact) fn forget_edges(&mut self) {
        self.shapes.forget_edges();
    }

    /// How far colliders have pushed any particle in the last sub-step, at most (m).
    pub(crate) fn farthest_push(&self, substep: SubStep) -> f32 {
        self.moved_now - substep.farthest_move
    }
}
