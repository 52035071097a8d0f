//! Bodies that are carried while springs are solved.

use super::{Detection, send_on};
use crate::{
    cloth::ClothParticles,
    contact::{MovingCollider, body::Body, carriers::Carrier},
    solver::SubStep,
};

impl Detection {
    /// The particles that carry a body as the tick ends, if this collider is one and was near.
    pub(crate) fn carriers(&self, id: usize) -> &[Carrier] {
        let body = self.bodies.iter().find(|body| body.id == id);
        body.map_or(&[], |body| body.carriers.as_slice())
    }

    /// How many times as heavy as the particles of the threads by which it hangs the heaviest body is that particles carry, as far as
    /// they have held it in a tick in which it falls by so much (m/s); 0 if they carry none.
    pub(crate) fn load_ratio(&self, fall: f32) -> f32 {
        let ratio = |body: &Body| {
            let held = body.change().velocity.length();
            body.carriers.load_ratio(held, fall)
        };
        self.bodies.iter().map(ratio).fold(0.0, f32::max)
    }

    /// Begins a tick of so many sub-steps with the particles that carried a body as the last one ended, those of each collider's number.
    pub(crate) fn recall<C: Iterator<Item = Carrier>>(
        &mut self,
        particles: &mut ClothParticles,
        substeps: u32,
        of: impl Fn(usize) -> C,
    ) {
        for body in &mut self.bodies {
            body.carriers.recall(of(body.id));
        }
        self.lend(particles, SubStep::first_of(substeps));
    }

    /// Has particles carry what they were just pushed by, in the coming sub-step.
    pub(super) fn lend(&mut self, particles: &mut ClothParticles, coming: SubStep) {
        particles.loads_mut().clear();
        for index in 0..self.bodies.len() {
            let (others, rest) = self.bodies.split_at_mut(index);
            let Some(way) = way_of(&self.colliders, rest[0].id) else {
                continue;
            };
            let others = others.iter().map(|body| &body.carriers);
            rest[0].lend(particles, (way, coming), others);
        }
    }

    /// Gives bodies what the sub-step that has just ended gave to what particles carried. Returns whether any was moved.
    pub(super) fn take_back(&mut self, particles: &mut ClothParticles, substep: SubStep) -> bool {
        if !particles.has_loads() {
            return false;
        }
        let mut has_carried = false;
        for body in &mut self.bodies {
            let Some(way) = way_of(&self.colliders, body.id) else {
                continue;
            };
            let mut way = way.clone();
            let Some((given, gone)) = body.take_back(particles, &mut way, substep) else {
                continue;
            };
            has_carried = true;
            self.deviation = self.deviation.max(body.deviation(&way, substep.end()));
            if let Some(touch) = self.touches.iter_mut().find(|touch| touch.id == body.id) {
                touch.traveled += gone;
                let seconds = f64::from(particles.substep());
                touch.impulse += (given.linear / seconds).as_vec3();
                touch.angular_impulse += (given.angular / seconds).as_vec3();
            }
            send_on(&mut self.touches, &mut self.colliders, body.id, &way);
        }
        particles.loads_mut().clear();
        has_carried
    }
}

fn way_of(colliders: &[(usize, MovingCollider)], id: usize) -> Option<&MovingCollider> {
    let known = colliders.iter().find(|(known, _)| *known == id);
    known.map(|(_, way)| way)
}
