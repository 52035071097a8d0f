//! Repeats the search when candidates may be missing.

use bevy::math::Vec3;

use super::{Detection, send_on};
use crate::{
    cloth::ClothParticles,
    contact::candidates::{ContactSettings, Ranges},
};

/// Number of measurements of the particles' displacements in a sub-step, before a new search.
const MAX_MEASURED: u32 = 2;

impl Detection {
    /// Begins the same tick again, from the same particles.
    pub fn restart(&mut self) {
        self.shapes.clear();
        self.shapes.memories.restart();
        for touch in &mut self.touches {
            (touch.deepest, touch.area, touch.volume) = (0.0, 0.0, 0.0);
            (touch.impulse, touch.angular_impulse) = (Vec3::ZERO, Vec3::ZERO);
            touch.travelled = 0.0;
        }
        self.candidates.restart();
        self.odometer = 0.0;
        for body in &mut self.bodies {
            let moving = body.restart();
            self.deviation = self.deviation.max(body.deviation(&moving, 0.0));
            send_on(&mut self.touches, &mut self.colliders, body.id, &moving);
        }
        // Later searches used the particles' positions of that time.
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

    /// Whether particles have moved so far that candidates may be missing. The sum of all moves is checked first; it
    /// includes all jitter, so the displacement is then measured.
    pub(super) fn is_outrun(&mut self, particles: &ClothParticles) -> bool {
        // Also true for NaN.
        let is_beyond = |moved: f32, margin: f32| moved > margin || moved.is_nan();
        if !is_beyond(self.moved + self.deviation, self.margin) {
            return false;
        }
        // A new search widens the margin: that is cheaper than a measurement for every push.
        if self.has_origin && self.measured < MAX_MEASURED {
            self.measured += 1;
            self.moved = particles.farthest_from(&self.origin);
        }
        is_beyond(self.moved + self.deviation, self.margin)
    }

    /// Repeats the search for all colliders after a number of sub-steps, with the current particles.
    pub(super) fn search(
        &mut self,
        particles: &ClothParticles,
        settings: &ContactSettings,
        passed: u32,
    ) {
        if self.colliders.is_empty() {
            // Nothing can be missed.
            self.margin = f32::INFINITY;
            return;
        }
        self.requeries += 1;
        // Twice the margin that was too small: so a tick has few repetitions, however violent it is.
        let finite = |length: f32| if length.is_finite() { length } else { 0.0 };
        let moved_now = finite(self.moved_now);
        self.margin = 2.0 * finite(self.moved).max(moved_now).max(self.margin);
        // The motion of this sub-step has already happened.
        self.moved = moved_now;
        self.remember(particles);
        self.deviation = 0.0;
        for body in &mut self.bodies {
            if let Some((_, moving)) = self.colliders.iter().find(|(id, _)| *id == body.id) {
                body.set_searched(moving);
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
            // Tested particles stay candidates, so that no contact is forgotten.
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

    /// Takes pushes by anything else into account, of at most this distance (m).
    pub fn note_push(&mut self, farthest: f32) {
        self.moved += farthest;
        self.moved_now += farthest;
        self.odometer += farthest;
    }

    /// Clears the memory of edges.
    #[cfg(test)]
    pub(crate) fn forget_edges(&mut self) {
        self.shapes.forget_edges();
    }
}
