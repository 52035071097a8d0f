//! Dynamic colliders: bodies with a mass, which cloth pushes back.

use bevy::math::{DVec3, Isometry3d, Quat, Vec3};

use super::carriers::Carriers;
use crate::{
    cloth::{Block, ClothParticles, LANES, MapInline},
    contact::{
        colliders::{BodyMass, ColliderSubstep, MovingCollider, swing},
        friction::Impulse,
    },
    solver::SubStep,
};

/// The change that cloth has made to a body's motion.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct BodyChange {
    /// Change of the velocity of its centre of mass (m/s).
    pub velocity: Vec3,
    /// Change of its angular velocity (rad/s).
    pub angular_velocity: Vec3,
    /// Change of its shape's origin at the end of the tick (m).
    pub translation: Vec3,
    /// Change of its rotation at the end of the tick: axis × angle (rad).
    pub rotation: Vec3,
}

impl BodyChange {
    /// Whether all values are finite.
    pub fn is_finite(&self) -> bool {
        self.velocity.is_finite()
            && self.angular_velocity.is_finite()
            && self.translation.is_finite()
            && self.rotation.is_finite()
    }

    /// The sum of this and another one.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            velocity: self.velocity + other.velocity,
            angular_velocity: self.angular_velocity + other.angular_velocity,
            translation: self.translation + other.translation,
            rotation: self.rotation + other.rotation,
        }
    }

    /// A multiple of it.
    pub(crate) fn times(self, factor: f32) -> Self {
        Self {
            velocity: self.velocity * factor,
            angular_velocity: self.angular_velocity * factor,
            translation: self.translation * factor,
            rotation: self.rotation * factor,
        }
    }

    /// The same change in a rotated frame.
    pub fn turned(self, rotation: Quat) -> Self {
        Self {
            velocity: rotation * self.velocity,
            angular_velocity: rotation * self.angular_velocity,
            translation: rotation * self.translation,
            rotation: rotation * self.rotation,
        }
    }
}

/// A body during a tick, changed by the pushes of each sub-step.
///
/// A sub-step first pushes the particles as if the body were static. That gives the impulse `g = Σ m Δx` and, with the
/// body's inverse mass matrix W, the body's displacement `W g` under that impulse. Particles and body then share the
/// correction: the particles move by the fraction `s` of theirs, and the body by `s W g`. The mass-weighted remaining
/// error is least for
///
/// ```text
/// s = a / (a + gᵀ W g),   a = Σ m Δx²
/// ```
///
/// A heavy body gives s = 1; particles of mass m moving one way and a body of mass M share as M to m. Momentum is
/// conserved, and kinetic energy never grows: where the full push takes `a`, it changes by
/// `−s a + s² (a + gᵀ W g) / 2 ≤ 0`.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    /// Index of the caller's collider.
    pub id: usize,
    pub(super) mass: BodyMass,
    /// Its motion without any contact.
    start: MovingCollider,
    /// Its motion when candidates were last searched for.
    searched: MovingCollider,
    /// The change of its motion so far in the tick.
    pub change: BodyChange,
    /// The part of that by what it stands on.
    pub held: BodyChange,
    /// The particles that carry it while springs are solved.
    pub carriers: Carriers,
}

/// Linear and angular impulse times the sub-step, given by particles (kg·m, kg·m²) about a centre, and `Σ m Δx²`
/// (kg·m²).
#[derive(Debug, Default, Clone, Copy)]
struct PushSum {
    push: DVec3,
    turn: DVec3,
    square: f64,
}

impl PushSum {
    fn add(&mut self, mass: f64, offset: DVec3, displacement: Vec3) {
        let displacement = displacement.as_dvec3();
        self.push += mass * displacement;
        self.turn += offset.cross(mass * displacement);
        self.square += mass * displacement.length_squared();
    }

    /// The fraction that the particles keep, and the body's displacement and rotation.
    fn shared(&self, mass: &BodyMass) -> (f32, DVec3, DVec3) {
        let go = f64::from(mass.inverse_mass) * (mass.free.as_dmat3() * self.push);
        let turn = mass.inverse_inertia.as_dmat3() * self.turn;
        let body = go.dot(self.push) + turn.dot(self.turn);
        let part = self.square / (self.square + body);
        // Nothing was pushed, or the numbers are not finite.
        if !(part.is_finite() && go.is_finite() && turn.is_finite()) {
            return (1.0, DVec3::ZERO, DVec3::ZERO);
        }
        (part as f32, -part * go, -part * turn)
    }
}

impl Body {
    /// The body of a collider, if the collider is dynamic. Reuses the memory of an earlier body.
    pub fn of(id: usize, collider: &MovingCollider, spare: &mut Vec<Carriers>) -> Option<Self> {
        let mass = collider.body?;
        let mut carriers = spare.pop().unwrap_or_default();
        carriers.clear();
        Some(Self {
            id,
            mass,
            start: collider.clone(),
            searched: collider.clone(),
            change: BodyChange::default(),
            held: BodyChange::default(),
            carriers,
        })
    }

    /// Notes that what it stands on has changed its motion since.
    pub(super) fn add_held(&mut self, before: BodyChange) {
        self.held = self.held.plus(self.change.plus(before.times(-1.0)));
    }

    /// Begins the tick again. Returns the original motion.
    pub fn restart(&mut self) -> MovingCollider {
        (self.change, self.held) = Default::default();
        self.carriers.clear();
        self.start.clone()
    }

    /// Notes the motion with which candidates have been searched for.
    pub fn set_searched(&mut self, moving: &MovingCollider) {
        self.searched = moving.clone();
    }

    /// Largest distance of any point of its surface from its expected position in the rest of the tick (m).
    pub fn deviation(&self, moving: &MovingCollider, passed: f32) -> f32 {
        let deviation = |part: f32| {
            let (expected, is) = (self.searched.pose_at(part), moving.pose_at(part));
            let turned = is.rotation.angle_between(expected.rotation);
            let gone = Vec3::from(is.translation).distance(expected.translation.into());
            gone + swing(turned, moving.shape.core_extent())
        };
        deviation(passed).max(deviation(1.0))
    }

    /// Shares a push between particles, which were pushed as if the body were static, and the body. Returns the
    /// fraction of the momentum that the particles keep, and the body's displacement (m). `may_carry` tells whether a
    /// particle may carry the body, by the body's outward normal there. `before` are the blocks of all that may have been
    /// pushed, as they were.
    pub fn share(
        &mut self,
        before: &[(usize, Block)],
        particles: &mut ClothParticles,
        moving: &mut MovingCollider,
        substep: SubStep,
        may_carry: impl Fn(Vec3) -> bool,
    ) -> [f32; 2] {
        let (pose, centre) = self.centre(moving, substep.end());
        let out = |place: Vec3| moving.shape.nearest(pose, place).normal;
        let (mut places, mut moves) = (PushSum::default(), PushSum::default());
        for (index, old) in before {
            let new = &particles.blocks()[*index];
            self.carriers.note(*index, [old, new], out, &may_carry);
            for lane in 0..LANES {
                let inverse_mass = new.inverse_mass(lane);
                let position = new.position(lane);
                if inverse_mass == 0.0 || position == old.position(lane) {
                    continue;
                }
                let mass = 1.0 / f64::from(inverse_mass);
                let offset = position.as_dvec3() - centre;
                places.add(mass, offset, position - old.position(lane));
                let moved = new.displacement(lane) - old.displacement(lane);
                moves.add(mass, offset, moved);
            }
        }
        let (place_part, go, turn) = places.shared(&self.mass);
        let (move_part, push, spin) = moves.shared(&self.mass);
        for (index, old) in before {
            let new = &mut particles.blocks_mut()[*index];
            for lane in 0..LANES {
                let [from, to] = [old.position(lane), new.position(lane)];
                if to != from {
                    new.set_position(lane, from.lerp(to, place_part));
                    let [from, to] = [old.displacement(lane), new.displacement(lane)];
                    new.set_displacement(lane, from.lerp(to, move_part));
                }
            }
        }
        self.carriers.add_noted();
        let gone = self.send_on(moving, substep, particles.substep(), [go, turn, push, spin]);
        [move_part, gone]
    }

    /// Makes particles carry the body in the coming sub-step, unless they already carry another one.
    pub fn attach_load<'a>(
        &mut self,
        particles: &mut ClothParticles,
        (moving, coming): (&MovingCollider, SubStep),
        others: impl Iterator<Item = &'a Carriers> + Clone,
    ) {
        let (pose, centre) = self.centre(moving, coming.start());
        let motion = ColliderSubstep {
            origin: pose.translation.into(),
            ..moving.in_substep(coming)
        };
        let surface = |place: Vec3| motion.surface_motion(place);
        let body = (&self.mass, centre);
        self.carriers.attach_load(particles, body, surface, others);
    }

    /// Collects the impulses of the particles that carried the body in a sub-step, and updates its motion. Returns the
    /// impulse about the origin of its shape, and the body's displacement (m); `None` if there was no impulse.
    pub fn detach_load(
        &mut self,
        particles: &mut ClothParticles,
        moving: &mut MovingCollider,
        substep: SubStep,
    ) -> Option<(Impulse, f32)> {
        let (pose, centre) = self.centre(moving, substep.end());
        let [push, turn] = self.carriers.detach_load(particles, centre);
        let arm = centre - Vec3::from(pose.translation).as_dvec3();
        let given = Impulse {
            linear: push,
            angular: turn + arm.cross(push),
        };
        let go = f64::from(self.mass.inverse_mass) * (self.mass.free.as_dmat3() * push);
        let spin = self.mass.inverse_inertia.as_dmat3() * turn;
        if !(go.is_finite() && spin.is_finite()) || [push, turn] == [DVec3::ZERO; 2] {
            return None;
        }
        let gone = self.send_on(moving, substep, particles.substep(), [go, spin, go, spin]);
        Some((given, gone))
    }

    /// Its pose at a fraction of the tick, and its centre of mass then (m).
    pub(super) fn centre(&self, moving: &MovingCollider, passed: f32) -> (Isometry3d, DVec3) {
        let pose = moving.pose_at(passed);
        let arm = self.arm(&pose);
        (pose, (Vec3::from(pose.translation) + arm).as_dvec3())
    }

    /// Vector from the origin of its shape to its centre of mass (m).
    fn arm(&self, pose: &Isometry3d) -> Vec3 {
        pose.rotation * self.start.from.rotation.inverse() * self.mass.centre
    }

    /// Updates its motion at the end of a sub-step of `dt` (s), with an additional displacement (m) and rotation (rad),
    /// and with a change of its displacement per sub-step. Returns the largest displacement of any of its points (m).
    pub(super) fn send_on(
        &mut self,
        moving: &mut MovingCollider,
        substep: SubStep,
        dt: f32,
        changes: [DVec3; 4],
    ) -> f32 {
        let passed = substep.end();
        let pose = moving.pose_at(passed);
        let arm = self.arm(&pose);
        let substeps = substep.count as f32;
        let [go, turn, push, spin] = changes.map_inline(DVec3::as_vec3);
        self.change.velocity += push / dt;
        self.change.angular_velocity += spin / dt;
        // It continues from its current pose with its current velocity.
        let rotation = (Quat::from_scaled_axis(turn) * pose.rotation).normalize();
        let here = Vec3::from(pose.translation) + go + arm - Quat::from_scaled_axis(turn) * arm;
        let step =
            moving.to - Vec3::from(moving.from.translation) + (push - spin.cross(arm)) * substeps;
        moving.turn += spin * substeps;
        moving.from = Isometry3d::new(
            here - step * passed,
            (Quat::from_scaled_axis(-moving.turn * passed) * rotation).normalize(),
        );
        moving.to = here + step * (1.0 - passed);
        let (end, expected) = (moving.pose_at(1.0), self.start.pose_at(1.0));
        self.change.translation = moving.to - self.start.to;
        let rotation = end.rotation * expected.rotation.inverse();
        let is_opposite = rotation.w < 0.0;
        let rotation = if is_opposite { -rotation } else { rotation };
        self.change.rotation = rotation.to_scaled_axis();
        let swing = turn.length() * (moving.shape.core_extent() + arm.length());
        let swing = if swing > 0.0 { swing } else { 0.0 };
        go.length() + swing
    }
}
