//! Carries bodies while springs are solved.

use super::{Detection, send_on};
use crate::{
    cloth::ClothParticles,
    contact::{
        bodies::{Body, Carrier},
        colliders::moving_of,
    },
    solver::SubStep,
};

impl Detection {
    /// The particles that carry a body at the end of the tick, if this collider is dynamic and was near.
    pub(crate) fn carriers(&self, id: usize) -> &[Carrier] {
        let body = self.bodies.iter().find(|body| body.id == id);
        body.map_or(&[], |body| &body.carriers.all)
    }

    /// Largest ratio of a carried body's mass to that of the chains that hold it, times the fraction of its weight
    /// that they hold. `fall` is the velocity that gravity adds in a tick (m/s). 0 if nothing is carried.
    pub(crate) fn load_ratio(&self, fall: f32) -> f32 {
        let ratio = |body: &Body| {
            let held = body.change.velocity.length();
            body.carriers.load_ratio(held, fall)
        };
        self.bodies.iter().map(ratio).fold(0.0, f32::max)
    }

    /// Begins a tick of some sub-steps with the particles that carried each collider's body at the end of the last
    /// tick.
    pub(crate) fn recall<C: Iterator<Item = Carrier>>(
        &mut self,
        particles: &mut ClothParticles,
        substeps: u32,
        of: impl Fn(usize) -> C,
    ) {
        for body in &mut self.bodies {
            body.carriers.recall(of(body.id));
        }
        self.supports.clear();
        self.find_supports(particles, 0.0);
        self.attach_load(particles, SubStep::first_of(substeps));
    }

    /// Makes particles carry the bodies that have just pushed them, in the coming sub-step.
    pub(super) fn attach_load(&mut self, particles: &mut ClothParticles, coming: SubStep) {
        particles.loads_mut().clear();
        for index in 0..self.bodies.len() {
            let (others, rest) = self.bodies.split_at_mut(index);
            let Some(moving) = moving_of(&self.colliders, rest[0].id) else {
                continue;
            };
            let others = others.iter().map(|body| &body.carriers);
            rest[0].attach_load(particles, (moving, coming), others);
        }
    }

    /// Applies the impulses of the last sub-step to the carried bodies. Returns whether any moved.
    pub(super) fn detach_load(&mut self, particles: &mut ClothParticles, substep: SubStep) -> bool {
        if !particles.has_loads() {
            return false;
        }
        let mut has_carried = false;
        for body in &mut self.bodies {
            let Some(mut moving) = moving_of(&self.colliders, body.id).cloned() else {
                continue;
            };
            let Some((given, gone)) = body.detach_load(particles, &mut moving, substep) else {
                continue;
            };
            has_carried = true;
            self.margin.deviate(body.deviation(&moving, substep.end()));
            if let Some(touch) = self.touches.iter_mut().find(|touch| touch.id == body.id) {
                touch.travelled += gone;
                touch.add_impulse(&given, particles.substep());
            }
            send_on(&mut self.touches, &mut self.colliders, body.id, &moving);
        }
        particles.loads_mut().clear();
        has_carried
    }
}
