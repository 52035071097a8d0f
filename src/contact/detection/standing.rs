//! Bodies that stand on other colliders, through the cloth between them.

use super::{Detection, send_on};
use crate::{
    cloth::{ClothParticles, MapInline},
    contact::{
        bodies::{ContactStep, Near, Stand, StandingResponse, Supports},
        candidates::{Candidates, ContactSettings, Touch},
        colliders::moving_of,
    },
    solver::SubStep,
};

impl Detection {
    /// Finds where bodies stand at a fraction of the tick.
    pub(super) fn find_supports(&mut self, particles: &ClothParticles, passed: f32) {
        self.supports.begin_search(passed);
        for body in &self.bodies {
            let Some(touch) = self.touches.iter().find(|touch| touch.id == body.id) else {
                continue;
            };
            if self.is_embedded(body.id) {
                continue;
            }
            let near = Near {
                candidates: &self.candidates.all[touch.of.candidates.clone()],
                surface: &self.surface,
                particles,
                radius: self.particle_radius,
            };
            // On another body it is carried.
            let fixed = (self.touches.iter()).filter(|other| other.collider.body.is_none());
            for ground in fixed {
                let pair = [touch, ground].map_inline(|touch| (touch.id, &touch.collider));
                self.supports.find(pair, &near, passed);
            }
        }
    }

    /// Searches for the supports anew if a body that stands has rolled.
    pub(super) fn follow_rolling(&mut self, particles: &ClothParticles, passed: f32) {
        let have_rolled = |id: usize| {
            let moving = moving_of(&self.colliders, id);
            moving.is_some_and(|moving| self.supports.have_rolled(moving, passed))
        };
        let mut stands = self.supports.stands.iter();
        if stands.any(|stand| have_rolled(stand.body)) {
            self.find_supports(particles, passed);
        }
    }

    /// The response of each body that stands, of what it stands on, and of the cloth between. Returns whether anything moved.
    pub(super) fn stand(
        &mut self,
        particles: &mut ClothParticles,
        settings: &ContactSettings,
        substep: SubStep,
        response: StandingResponse,
    ) -> bool {
        if self.supports.stands.is_empty() {
            return false;
        }
        let mut has_stood = false;
        for body in &mut self.bodies {
            let Some(mut moving) = moving_of(&self.colliders, body.id).cloned() else {
                continue;
            };
            let step = ContactStep {
                colliders: &self.colliders,
                settings,
                grips: &self.candidates.grips,
                substep,
            };
            let supports = &mut self.supports;
            let Some(stood) = body.stand(supports, particles, &mut moving, &step, response) else {
                continue;
            };
            has_stood = true;
            self.margin.deviate(body.deviation(&moving, substep.end()));
            self.margin.note(stood.pushed);
            let (id, seconds) = (body.id, particles.substep());
            for touch in &mut self.touches {
                let mut stands = self.supports.stands.iter();
                let is_own = |stand: &&Stand| (stand.body, stand.ground) == (id, touch.id);
                if let Some(stand) = stands.find(is_own) {
                    touch.add_impulse(&stand.given, seconds);
                }
                if touch.id == id {
                    touch.add_impulse(&stood.given, seconds);
                    touch.travelled += stood.gone;
                }
            }
            // In each sub-step: it may roll off in the next one.
            if self.supports.is_held(id)
                && let Some(touch) = self.touches.iter().find(|touch| touch.id == id)
            {
                note_pressed(touch, &mut self.candidates, &self.supports);
            }
            send_on(&mut self.touches, &mut self.colliders, body.id, &moving);
        }
        has_stood
    }
}

/// A body touches the particles that it presses, however little.
fn note_pressed(touch: &Touch, candidates: &mut Candidates, supports: &Supports) {
    let near = &candidates.all[touch.of.candidates.clone()];
    let stands = supports.stands.iter();
    let own = stands.filter(|stand| stand.body == touch.id);
    for particle in own.flat_map(|stand| &supports.between[stand.between.clone()]) {
        let known = near.binary_search_by_key(particle, |candidate| candidate.particle);
        if let Ok(at) = known {
            let (block, lane) = near[at].lane();
            let depth = &mut candidates.blocks[block].depth[lane];
            *depth = depth.max(f32::MIN_POSITIVE);
        }
    }
}
