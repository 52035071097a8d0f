//! The narrow phase by particles against shapes with an expensive nearest point. It is computed where a particle has
//! moved since; in between, its plane is reused.

use bevy::math::{Isometry3d, Vec3};

use super::{
    MovingCollider,
    guard::Guard,
    nearest::Nearest,
    particle::Found,
    pushing::Pushing,
    response::{Contact, first_touch},
    touch::ContactSettings,
};
use crate::{
    cloth::{ClothParticles, Slot},
    solver::SubStep,
};

/// A particle that has moved less than this fraction of its radius is tested against the last plane. For a flat surface
/// that is exact; another part of a mesh may be nearer by at most twice as much.
const SAME_PLANE: f32 = 0.1;

/// The last test of a particle against a shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownParticle {
    /// Position in the shape's frame (m); NaN before the first test.
    pub at: Vec3,
    pub nearest: Nearest,
    /// Until when it cannot touch, by the guard.
    clear: f32,
}

impl Default for KnownParticle {
    fn default() -> Self {
        Self {
            at: Vec3::NAN,
            nearest: Nearest {
                distance: 0.0,
                normal: Vec3::Y,
            },
            clear: f32::NEG_INFINITY,
        }
    }
}

/// Pushes candidates out that are inside a shape, or that passed through it in this sub-step.
pub(super) fn push_particles_out(
    particles: &mut ClothParticles,
    pushing: &mut Pushing,
    known: &mut [KnownParticle],
    guard: &Guard,
) -> Found {
    let (collider, settings, substep) = (pushing.collider, pushing.settings, pushing.substep);
    let radius = settings.particle_radius;
    let pose = collider.pose_at(substep.end());
    let to_local = pose.inverse();
    let origin = Vec3::from(pose.translation);
    let way = Way::new(collider, substep, settings);
    let mut found = Found::default();
    for (candidate, known) in pushing.candidates.iter().zip(known) {
        let (index, slot) = pushing.place(candidate);
        if guard.is_clear(known.clear, &[slot]) {
            continue;
        }
        let Slot { block: at, lane } = slot;
        let block = &particles.blocks()[at];
        let inverse_mass = block.inverse_mass(lane);
        if inverse_mass == 0.0 {
            continue;
        }
        let (position, displacement) = (block.position(lane), block.displacement(lane));
        let local = to_local * position;
        let moved = local.distance(known.at);
        let swept = way.swept(displacement);
        // The shape cannot have come near since. False for NaN.
        let left = known.nearest.distance - moved - swept;
        if left > radius {
            pushing.note_depth(index, lane, radius - known.nearest.distance - moved);
            known.clear = guard.until(known.nearest.distance - moved - radius, &[slot]);
            continue;
        }
        let is_same = moved <= SAME_PLANE * radius;
        if !is_same {
            known.at = local;
            known.nearest = collider.shape.nearest(Isometry3d::IDENTITY, local);
        }
        let Nearest { distance, normal } = known.nearest;
        let distance = distance + normal.dot(local - known.at);
        let (mut normal, mut depth) = (pose.rotation * normal, radius - distance);
        if swept > 0.0
            && let Some(hit) = way.hit(position, displacement)
        {
            (normal, depth) = hit;
        }
        // NaN is no push.
        let is_inside = depth > 0.0;
        pushing.note_depth(index, lane, depth);
        if !is_inside {
            continue;
        }
        let point = position + normal * (depth - radius);
        let surface = collider.surface_motion(substep, origin, point);
        let push = Contact {
            normal,
            depth,
            relative: displacement - surface,
        }
        .push(settings.friction, &pushing.lanes.push_out);
        let block = &mut particles.blocks_mut()[at];
        let pushed = position + push.position;
        block.set_position(lane, pushed);
        block.set_displacement(lane, displacement + push.displacement);
        let given = &mut found.given;
        given.add(pushed - origin, push.displacement, inverse_mass);
        found.deepest = found.deepest.max(depth);
        found.farthest_push = found.farthest_push.max(push.position.length());
        let area = pushing.contacts[index].area[lane];
        found.area += area;
        found.volume += area * depth;
    }
    found
}

/// A sub-step's motion, for tests of fast particles.
struct Way<'a> {
    collider: &'a MovingCollider,
    substep: SubStep,
    radius: f32,
    /// Radius and depth up to which the side is known (m).
    thickness: f32,
    /// Displacement of the collider in the sub-step, and the largest one of any of its points by rotation (m).
    slide: Vec3,
    swing: f32,
    is_on: bool,
}

impl<'a> Way<'a> {
    fn new(collider: &'a MovingCollider, substep: SubStep, settings: &ContactSettings) -> Self {
        let count = substep.count as f32;
        Self {
            collider,
            substep,
            radius: settings.particle_radius,
            thickness: settings.particle_radius + collider.shape.thickness(),
            slide: (collider.to - Vec3::from(collider.from.translation)) / count,
            swing: collider.swing() / count,
            is_on: settings.is_swept,
        }
    }

    /// Displacement of a particle relative to the shape, if it may have passed through (m); else 0.
    fn swept(&self, displacement: Vec3) -> f32 {
        let speed = (displacement - self.slide).length() + self.swing;
        if self.is_on && speed > self.thickness / 2.0 && speed.is_finite() {
            speed
        } else {
            0.0
        }
    }

    /// The normal where a particle from outside hit the shape, and its displacement along it to stay in front of the
    /// surface (m).
    fn hit(&self, position: Vec3, displacement: Vec3) -> Option<(Vec3, f32)> {
        let start = position - displacement;
        let count = self.substep.count as f32;
        let begin = self.substep.index as f32 / count;
        let nearest = |part: f32| {
            self.collider
                .nearest(begin + part / count, start + displacement * part)
        };
        // For a particle this deep already, the original side is unknown.
        if nearest(0.0).distance < self.radius - self.thickness / 2.0 {
            return None;
        }
        let speed = self.swept(displacement);
        let tolerance = 1.0e-2 * self.thickness;
        let part = first_touch(speed, self.radius, tolerance, |part| nearest(part).distance)?;
        let Nearest { distance, normal } = nearest(part);
        let way = [begin + part / count, self.substep.end()];
        let (carried, normal) = self
            .collider
            .carry(way, start + displacement * part, normal);
        let depth = normal.dot(carried - position) + (self.radius - distance);
        (depth > 0.0).then_some((normal, depth))
    }
}
