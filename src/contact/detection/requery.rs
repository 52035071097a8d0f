//! Repeats the search when candidates may be missing.

use bevy::math::Vec3;

use super::{Detection, send_on};
use crate::{
    cloth::ClothParticles,
    contact::{
        candidates::{ContactSettings, Ranges},
        colliders::moving_of,
    },
};

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
        for body in &mut self.bodies {
            let moving = body.restart();
            self.margin.deviate(body.deviation(&moving, 0.0));
            send_on(&mut self.touches, &mut self.colliders, body.id, &moving);
        }
        self.margin.restart(self.requeries > 0);
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
            self.margin.open();
            return;
        }
        self.requeries += 1;
        self.margin.widen(particles);
        for body in &mut self.bodies {
            if let Some(moving) = moving_of(&self.colliders, body.id) {
                body.set_searched(moving);
            }
        }
        self.saved.take(&self.touches, &self.candidates);
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
            let radius = cloth.radius() + probe.reach() as f32;
            if probe.core.may_reach(cloth.center.into(), radius) {
                found.scan(particles, &probe);
            }
            // Tested particles stay candidates, so that no contact is forgotten.
            let found = found.candidates().iter().copied();
            let all: Vec<u32> = self.saved.particles(*id).chain(found).collect();
            self.list(*id, collider, narrow_phase, passed, &all, particles);
        }
        self.colliders = colliders;
        self.found = found;
        self.saved.give_back(&self.touches, &mut self.candidates);
    }

    /// Takes pushes by anything else into account, of at most this distance (m).
    pub fn note_push(&mut self, farthest: f32) {
        self.margin.note(farthest);
    }

    /// Clears the memory of edges.
    #[cfg(test)]
    pub(crate) fn forget_edges(&mut self) {
        self.shapes.forget_edges();
    }
}
