//! Holds a body that stands on the ground, and lets friction act on it and on the cloth between.

use bevy::math::{DVec3, Vec3};

use super::{
    point::{Motion, StandingPoint, inverse_mass, push_all, rub_all},
    supports::{Stand, Support, Supports, THICKNESS},
};
use crate::{
    cloth::{ClothParticles, Lanes, Slot},
    contact::{
        bodies::body::Body,
        candidates::ContactSettings,
        colliders::{BodyMass, ColliderSubstep, MovingCollider, moving_of},
        friction::{Impulse, PushOut},
    },
    solver::SubStep,
};

/// The cloth's contacts in a sub-step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactStep<'a> {
    /// All colliders, by their IDs.
    pub colliders: &'a [(usize, MovingCollider)],
    pub settings: &'a ContactSettings,
    /// Factors of μ, by the cloth's blocks; empty if all are 1.
    pub grips: &'a [Lanes],
    pub substep: SubStep,
}

/// One of the two responses of a body that stands, in a sub-step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum StandingResponse {
    /// The body is kept off what it stands on.
    KeepOff,
    /// Friction acts on the body, and on the cloth between it and what it stands on, after all else has pushed these.
    Rub,
}

/// The result of a sub-step of a body that stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StandingResult {
    /// Largest displacement of the body, and of a particle (m).
    pub gone: f32,
    pub pushed: f32,
    /// The impulse on the body, about the origin of its shape.
    pub given: Impulse,
}

impl<'a> ContactStep<'a> {
    fn ground(&self, stand: &Stand) -> Option<ColliderSubstep<'a>> {
        let ground = moving_of(self.colliders, stand.ground)?;
        Some(ground.in_substep(self.substep))
    }

    fn friction(&self, particles: &ClothParticles, particle: u32) -> f32 {
        let Slot { block, lane } = particles.layout().slot_of(particle as usize);
        let grip = self.grips.get(block).map_or(1.0, |grips| grips[lane]);
        self.settings.friction * grip
    }

    /// A support as the sub-step ends. `at` are its indices among the stands and the supports.
    fn point(
        &self,
        at: [usize; 2],
        support: &Support,
        [moving, ground]: [&ColliderSubstep; 2],
        (mass, centre, particles): (&BodyMass, DVec3, &ClothParticles),
    ) -> StandingPoint {
        let above = moving.pose * support.on_body;
        let below = ground.pose * support.on_ground;
        let normal = ground.pose.rotation * support.normal;
        let overlap = THICKNESS * self.settings.particle_radius - (above - below).dot(normal);
        let own = moving.surface_motion(above);
        let approach = (ground.surface_motion(below) - own).dot(normal);
        // A gap closes until the tick ends. Gravity comes once a tick: if it closed a gap at once, the body would rock.
        let left = (self.substep.count - self.substep.index) as f32;
        let stop = approach - (approach - overlap).max(0.0) / left;
        let older = overlap - stop.max(0.0);
        let release = match older > 0.0 {
            true => PushOut::new(particles.substep(), 0.0, 1.0).of(older),
            false => older,
        };
        let corners = support.cloth.corners.iter().zip(support.cloth.weights);
        let each = corners.map(|(corner, weight)| self.friction(particles, *corner) * weight);
        let coefficient: f32 = each.sum();
        let (arm, normal) = (above.as_dvec3() - centre, normal.as_dvec3());
        StandingPoint {
            stand: at[0],
            support: at[1],
            arm,
            below: (below - ground.origin).as_dvec3(),
            normal,
            stop: stop.into(),
            release: release.into(),
            inverse_mass: inverse_mass(mass, arm, normal),
            push: 0.0,
            before: support.pushed,
            released: 0.0,
            relative: -own.as_dvec3(),
            coefficient: coefficient.into(),
            unspent: support.unspent,
            friction: DVec3::ZERO,
        }
    }

    /// Slows the cloth below a body by friction from both sides. Returns the largest displacement of a particle (m).
    fn slow_cloth(
        &self,
        stand: &mut Stand,
        between: &[u32],
        particles: &mut ClothParticles,
        [moving, ground]: [&ColliderSubstep; 2],
    ) -> f32 {
        let left = self.substep.count - self.substep.index;
        let part = stand.unspent / f64::from(left);
        stand.unspent -= part;
        let share = part as f32 / between.len() as f32;
        let layout = particles.layout();
        let mut farthest = 0.0_f32;
        for &particle in between {
            let Slot { block, lane } = layout.slot_of(particle as usize);
            let friction = self.friction(particles, particle);
            let block = &mut particles.blocks_mut()[block];
            let inverse_mass = block.inverse_mass(lane);
            if inverse_mass == 0.0 {
                continue;
            }
            let (place, before) = (block.position(lane), block.displacement(lane));
            let normal = ground.nearest(place).normal;
            let most = friction * share * inverse_mass;
            let slowed = before - grip(before - moving.surface_motion(place), normal, most);
            let after = slowed - grip(slowed - ground.surface_motion(place), normal, most);
            block.set_position(lane, place + after - before);
            block.set_displacement(lane, after);
            // The body's share is taken from this in the end.
            (stand.given).add(place - ground.origin, after - before, inverse_mass);
            farthest = farthest.max(after.distance(before));
        }
        farthest
    }
}

/// The part of a displacement along a surface that friction takes, at most this much (m).
fn grip(displacement: Vec3, normal: Vec3, most: f32) -> Vec3 {
    let slip = displacement - normal * normal.dot(displacement);
    slip.clamp_length_max(most)
}

impl Supports {
    /// Forgets the impulses of the sub-step before.
    fn begin_substep(&mut self, body: usize) {
        for stand in self.stands.iter().filter(|stand| stand.body == body) {
            for support in &mut self.all[stand.supports.clone()] {
                support.pushed = 0.0;
            }
        }
    }

    /// The points where a body stands, as the sub-step ends.
    fn begin(
        &mut self,
        body: usize,
        motion: &ColliderSubstep,
        of: (&BodyMass, DVec3, &ClothParticles),
        step: &ContactStep,
    ) {
        self.points.clear();
        for (index, stand) in self.stands.iter_mut().enumerate() {
            stand.given = Impulse::default();
            let Some(ground) = step.ground(stand).filter(|_| stand.body == body) else {
                continue;
            };
            for at in stand.supports.clone() {
                let point = step.point([index, at], &self.all[at], [motion, &ground], of);
                self.points.push(point);
            }
        }
    }

    /// Lets friction act on the cloth below a body. Returns the largest displacement of a particle (m).
    fn slow(
        &mut self,
        particles: &mut ClothParticles,
        motion: &ColliderSubstep,
        step: &ContactStep,
    ) -> f32 {
        let mut farthest = 0.0_f32;
        for (index, stand) in self.stands.iter_mut().enumerate() {
            let is_own = self.points.iter().any(|point| point.stand == index);
            let Some(ground) = step.ground(stand).filter(|_| is_own) else {
                continue;
            };
            let between = &self.between[stand.between.clone()];
            let moved = step.slow_cloth(stand, between, particles, [motion, &ground]);
            farthest = farthest.max(moved);
        }
        for point in &mut self.points {
            let cloth = self.all[point.support].cloth;
            for (corner, weight) in cloth.corners.into_iter().zip(cloth.weights) {
                let displacement = particles.displacement(corner as usize);
                point.relative += (weight * displacement.unwrap_or_default()).as_dvec3();
            }
        }
        farthest
    }

    /// Notes the impulses at all points. Returns the one on the body, whose centre of mass is given, about a point (m).
    fn end(&mut self, [centre, about]: [DVec3; 2]) -> Impulse {
        let mut given = Impulse::default();
        for point in &self.points {
            let used = point.friction.length() / point.coefficient;
            let used = if used.is_finite() { used } else { 0.0 };
            let support = &mut self.all[point.support];
            support.pushed += point.push;
            support.unspent = (support.unspent + point.push - used).max(0.0);
            let stand = &mut self.stands[point.stand];
            stand.unspent = (stand.unspent + point.push).max(0.0);
            stand.holds |= support.pushed > 0.0;
            let impulse = point.normal * point.push + point.friction;
            given.merge(&Impulse {
                linear: impulse,
                angular: (centre + point.arm - about).cross(impulse),
            });
            stand.given.merge(&Impulse {
                linear: -impulse,
                angular: -point.below.cross(impulse),
            });
        }
        given
    }
}

impl Body {
    /// The response of the body at the points where it stands as the sub-step ends. `None` if it stands on nothing.
    pub fn stand(
        &mut self,
        supports: &mut Supports,
        particles: &mut ClothParticles,
        moving: &mut MovingCollider,
        step: &ContactStep,
        response: StandingResponse,
    ) -> Option<StandingResult> {
        if response == StandingResponse::KeepOff {
            supports.begin_substep(self.id);
        }
        let (pose, centre) = self.centre(moving, step.substep.end());
        let mass = self.mass;
        let motion = moving.in_substep(step.substep);
        supports.begin(self.id, &motion, (&mass, centre, particles), step);
        if supports.points.is_empty() {
            return None;
        }
        // The motion of the body, one of its place alone, and the largest displacement of a particle (m).
        let ([body, released], pushed) = match response {
            StandingResponse::KeepOff => (push_all(&mut supports.points, &mass), 0.0),
            StandingResponse::Rub => {
                let pushed = supports.slow(particles, &motion, step);
                let body = rub_all(&mut supports.points, &mass);
                ([body, Motion::default()], pushed)
            }
        };
        if !(body.is_finite() && released.is_finite()) {
            return None;
        }
        let given = supports.end([centre, Vec3::from(pose.translation).as_dvec3()]);
        let [go, turn] = [body.go + released.go, body.turn + released.turn];
        let changes = [go, turn, body.go, body.turn];
        let before = self.change;
        let gone = self.send_on(moving, step.substep, particles.substep(), changes);
        self.add_held(before);
        Some(StandingResult {
            gone,
            pushed,
            given,
        })
    }
}
