//! Pushes particles out of all colliders at the end of a sub-step.

use bevy::math::Vec3;

use super::{Detection, send_on};
use crate::{
    cloth::ClothParticles,
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::{MovingCollider, moving_of},
        friction::{Impulse, PushOut},
        particles::{ContactResult, ParticlesNearEdges, lane_motion, push_particles},
        triangles::{CoreMotion, ResumePoint, TrianglePush},
    },
    solver::SubStep,
};

/// A particle is pushed by six triangles, by at least a third of each.
const TRIANGLES_A_PUSH: f32 = 3.0;

/// Cloth that pushes a body which stands more sideways than this cosine does not carry it.
const SIDEWAYS: f32 = 0.7;

impl Detection {
    /// Pushes particles out of the colliders. Returns whether anything moved.
    pub(super) fn push_out(
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
            self.save_before(at, particles);
            self.hide(at, particles, substep);
            let (found, stopped) = self.push_out_of(at, from, particles, settings, substep);
            self.supports.show(particles);
            let given = self.share(at, &found, particles, substep);
            // Several triangles may push one particle.
            self.margin.note(found.farthest_push);
            is_pushed |= found.farthest_push > 0.0;
            let touch = &mut self.touches[at];
            touch.deepest = touch.deepest.max(found.deepest);
            touch.add_impulse(&given, particles.substep());
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

    /// Saves the particles that a collider may push, if it is a body, which takes its share afterwards.
    fn save_before(&mut self, at: usize, particles: &ClothParticles) {
        let touch = &self.touches[at];
        if self.bodies.iter().any(|body| body.id == touch.id) {
            let contacts = &self.candidates.blocks[touch.of.blocks.clone()];
            let blocks = contacts.iter().map(|contact| contact.block as usize);
            let blocks = blocks.chain(self.embedding.blocks(touch.id));
            self.before.clear();
            (self.before).extend(blocks.map(|block| (block, particles.blocks()[block])));
            self.before.sort_unstable_by_key(|(block, _)| *block);
            self.before.dedup_by_key(|(block, _)| *block);
        }
    }

    /// Hides what lies flat below a body that stands, until [`Supports::show`](crate::contact::bodies::Supports::show).
    fn hide(&mut self, at: usize, particles: &mut ClothParticles, substep: SubStep) {
        let touch = &self.touches[at];
        let contacts = &self.candidates.blocks[touch.of.blocks.clone()];
        let (colliders, passed) = (&self.colliders, substep.end());
        let nearest = |ground: usize, place: Vec3| {
            let ground = moving_of(colliders, ground);
            ground.map_or(f32::INFINITY, |ground| {
                ground.nearest(passed, place).distance
            })
        };
        let radius = self.particle_radius;
        (self.supports).hide(touch.id, contacts, particles, radius, nearest);
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
        let collider = &touch.collider;
        let candidates = &self.candidates.all[touch.of.candidates.clone()];
        let contacts = &mut self.candidates.blocks[touch.of.blocks.clone()];
        let first = touch.of.blocks.start;
        let is_guarded = collider.shape.has_edges() || collider.shape.is_geometry();
        // The guard measures the cloth.
        let odometer = if is_guarded { 0.0 } else { margin.odometer } + touch.travelled;
        let motion = collider.in_substep(substep);
        let seconds = particles.substep();
        let lanes_of = |shares: f32| {
            let push_out = PushOut::new(seconds, motion.travel(), shares);
            lane_motion(&motion, settings, push_out, odometer)
        };
        let lanes = lanes_of(1.0);
        self.embedding.hide(touch.id, particles);
        // Once, however often triangles are searched for again.
        let has_points = touch.of.has_points && from == ResumePoint::default();
        let points = match has_points && !is_guarded {
            true => push_particles(particles, contacts, (&mut [], 0), &motion, &lanes),
            false => ContactResult::default(),
        };
        let (found, stopped) = match touch.narrow_phase {
            _ if is_guarded => {
                self.shapes.reserve(self.candidates.all.len());
                let limit = collider.max_surface_travel(f32::INFINITY) + margin.size;
                let travelled = [touch.travelled, limit];
                (self.shapes.guard).measure(particles, &margin.origin, contacts, travelled);
                let mut pushing = ParticlesNearEdges {
                    candidates,
                    contacts,
                    first,
                    motion,
                    lanes: &lanes,
                    has_hidden: self.supports.has_hidden(),
                };
                let of = (touch.id, touch.of.candidates.clone());
                let by_triangles = touch.narrow_phase == NarrowPhase::Triangles;
                let cloth = (&mut *particles, &*self.surface);
                let found = self.shapes.push(cloth, &mut pushing, of, by_triangles);
                (found, None)
            }
            NarrowPhase::Triangles => {
                let mut pushed = TrianglePush {
                    candidates,
                    contacts,
                    first,
                    budgets: &mut self.candidates.budgets[touch.of.budgets.clone()],
                    fans: self.surface.fans(),
                    max_faces: self.surface.max_faces() as f32,
                    clearance: margin.left() - points.farthest_push,
                    moved: margin.moved_now,
                    is_measured: touch.is_measured_in(substep),
                    found: ContactResult::default(),
                    passed: 0.0,
                };
                let core = CoreMotion::new(motion, lanes_of(TRIANGLES_A_PUSH));
                let stopped = pushed.push(particles, &core, from);
                (pushed.found, stopped)
            }
            NarrowPhase::Auto | NarrowPhase::Particles => (ContactResult::default(), None),
        };
        let of = (touch.id, &motion);
        let blocks = &mut self.candidates.blocks;
        let embedded = self.embedding.push(particles, blocks, of, settings);
        (found.and(&points).and(&embedded), stopped)
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
            // A wave that hits the side of a cup does not carry it.
            let up = (self.supports).up_of(touch.id, &self.colliders, substep.end());
            let may_carry = |out: Vec3| up.is_none_or(|up| out.dot(up) < -SIDEWAYS);
            let [kept, gone] = body.share(&self.before, particles, &mut moving, substep, may_carry);
            given.scale(f64::from(kept));
            touch.travelled += gone;
            self.margin.deviate(body.deviation(&moving, substep.end()));
            let touches = std::slice::from_mut(touch);
            send_on(touches, &mut self.colliders, body.id, &moving);
        }
        given
    }
}
