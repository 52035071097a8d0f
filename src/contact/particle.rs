//! The narrow phase by particles: each is a ball of its own radius.

use bevy::math::{Isometry3d, Vec3};

use super::{
    MovingCollider,
    response::{Contact, MAX_STEPS, first_touch},
    shape::Nearest,
    touch::{Candidate, ContactSettings},
};
use crate::{
    cloth::{Block, ClothParticles, Slot},
    solver::SubStep,
};

/// What a sub-step's contacts come to.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Found {
    /// How deep the deepest was (m).
    pub deepest: f32,
    /// The farthest that anything was pushed (m).
    pub farthest_push: f32,
    /// Area of the cloth that was inside (m²).
    pub area: f32,
    /// ∫ depth dA over it (m³).
    pub volume: f32,
}

/// Pushes those candidates out that are inside of `collider`, or that passed through it in this sub-step.
///
/// Pinned particles are left where they are.
pub(super) fn push_particles(
    particles: &mut ClothParticles,
    candidates: &mut [Candidate],
    collider: &MovingCollider,
    settings: &ContactSettings,
    substep: SubStep,
) -> Found {
    let particle_radius = settings.particle_radius;
    let pose = collider.pose_at(substep.end());
    let centre = Vec3::from(pose.translation);
    let thickness = collider.shape.thickness() + particle_radius;
    let sweep = Sweep::new(collider, substep, settings, thickness);
    let mut side = None;
    let mut found = Found::default();
    for index in 0..candidates.len() {
        let candidate = candidates[index];
        let Slot { block, lane } = candidate.slot;
        let block = &particles.blocks()[block];
        if block.inverse_mass(lane) == 0.0 {
            continue;
        }
        let (position, displacement) = (block.position(lane), block.displacement(lane));
        let Nearest {
            distance,
            mut normal,
        } = collider.shape.nearest(pose, position);
        let mut depth = particle_radius - distance;
        if let Some((hit_normal, hit_depth)) = sweep.hit(position, displacement) {
            (normal, depth) = (hit_normal, hit_depth);
        } else if depth > thickness / 2.0 {
            // So deep that the nearest way out may be on the other side.
            let side = *side.get_or_insert_with(|| {
                side_of(
                    particles.blocks(),
                    candidates,
                    collider,
                    pose,
                    thickness,
                    particle_radius,
                )
            });
            if normal.dot(side) < 0.0 {
                let way = way_out(collider, pose, position, side, particle_radius);
                (normal, depth) = way.map_or((normal, depth), |depth| (side, depth));
            }
        }
        candidates[index].depth = candidate.depth.max(depth.min(thickness));
        if depth <= 0.0 {
            continue;
        }
        let surface = collider.surface_motion(
            substep,
            centre,
            position + normal * (depth - particle_radius),
        );
        let relative = displacement - surface;
        let push = Contact {
            normal,
            depth,
            relative,
        }
        .push(settings.friction);
        let block = &mut particles.blocks_mut()[candidate.slot.block];
        block.set_position(lane, position + push.position);
        block.set_displacement(lane, displacement + push.displacement);
        found.deepest = found.deepest.max(depth.min(thickness));
        found.farthest_push = found.farthest_push.max(push.position.length());
        found.area += candidate.area;
        found.volume += candidate.area * depth.min(thickness);
    }
    found
}

/// The test all along a sub-step, for what moves so far in it that the test at its end may come too late.
struct Sweep<'a> {
    collider: &'a MovingCollider,
    substep: SubStep,
    particle_radius: f32,
    thickness: f32,
    /// How far the collider moves in the sub-step, and any of its points turns (m).
    slide: Vec3,
    swing: f32,
    is_on: bool,
}

impl<'a> Sweep<'a> {
    fn new(
        collider: &'a MovingCollider,
        substep: SubStep,
        settings: &ContactSettings,
        thickness: f32,
    ) -> Self {
        let count = substep.count as f32;
        Self {
            collider,
            substep,
            particle_radius: settings.particle_radius,
            thickness,
            slide: (collider.to - Vec3::from(collider.from.translation)) / count,
            swing: collider.swing() / count,
            is_on: settings.is_swept,
        }
    }

    /// The normal where a particle that came from outside hit the collider, and how far it has to go along it to stay
    /// in front of the surface there.
    #[inline]
    fn hit(&self, position: Vec3, displacement: Vec3) -> Option<(Vec3, f32)> {
        let speed = (displacement - self.slide).length() + self.swing;
        // Who came less far than to half of the thickness is still on the side that it came from.
        if !self.is_on || speed <= self.thickness / 2.0 || !speed.is_finite() {
            return None;
        }
        let start = position - displacement;
        let begin = self.substep.index as f32 / self.substep.count as f32;
        let nearest = |part: f32| {
            let passed = begin + part / self.substep.count as f32;
            self.collider.nearest(passed, start + displacement * part)
        };
        // From what was so deep already, nobody knows from which side it came.
        if nearest(0.0).distance < self.particle_radius - self.thickness / 2.0 {
            return None;
        }
        let tolerance = 1.0e-3 * self.thickness;
        let part = first_touch(speed, self.particle_radius, tolerance, |part| {
            nearest(part).distance
        })?;
        let Nearest { distance, normal } = nearest(part);
        // Where it would be if it had gone on with the surface, which keeps it in front of all that is convex.
        let passed = begin + part / self.substep.count as f32;
        let way = [passed, self.substep.end()];
        let (carried, normal) = self
            .collider
            .carry(way, start + displacement * part, normal);
        let depth = normal.dot(carried - position) + (self.particle_radius - distance);
        (depth > 0.0).then_some((normal, depth))
    }
}

/// The side on which most of what is inside would leave: the mean of the normals, of length 1; 0 if they have none.
fn side_of(
    blocks: &[Block],
    candidates: &[Candidate],
    collider: &MovingCollider,
    pose: Isometry3d,
    thickness: f32,
    particle_radius: f32,
) -> Vec3 {
    let inside = candidates.iter().filter_map(|candidate| {
        let position = blocks[candidate.slot.block].position(candidate.slot.lane);
        let nearest = collider.shape.nearest(pose, position);
        // Those that were pushed out already are on the surface.
        (nearest.distance < particle_radius + 1.0e-3 * thickness).then_some(nearest.normal)
    });
    inside.sum::<Vec3>().normalize_or_zero()
}

/// How far it is along `side` to the surface (m), unless it is too far along the inside of a box to tell.
fn way_out(
    collider: &MovingCollider,
    pose: Isometry3d,
    position: Vec3,
    side: Vec3,
    particle_radius: f32,
) -> Option<f32> {
    let mut gone = 0.0;
    for _ in 0..MAX_STEPS {
        let depth = particle_radius
            - collider
                .shape
                .nearest(pose, position + side * gone)
                .distance;
        if depth <= 1.0e-6 * gone {
            return Some(gone);
        }
        gone += depth;
    }
    None
}
