//! Tests of a cloth triangle against a collider, at the end of a sub-step and on the way there.

use bevy::math::{Isometry3d, Vec3};

use super::lanes::MAX_SHARE;
use crate::{
    cloth::{Block, ClothParticles, MapInline, Slot, Surface},
    contact::{
        colliders::{ColliderSubstep, MovingCollider, NearestPoints, at, nearest},
        friction::{Impulse, first_touch},
        particles::LaneMotion,
    },
    hierarchy::{Core, Probe},
};

/// A triangle's particles at the end of a sub-step.
pub(crate) struct Corners {
    pub slots: [Slot; 3],
    pub positions: [Vec3; 3],
    pub displacements: [Vec3; 3],
    pub inverse_masses: [f32; 3],
}

impl Corners {
    #[inline]
    pub fn of(particles: &ClothParticles, slots: [Slot; 3]) -> Self {
        let block = |slot: Slot| &particles.blocks()[slot.block];
        Self {
            slots,
            positions: slots.map_inline(|slot| block(slot).position(slot.lane)),
            displacements: slots.map_inline(|slot| block(slot).displacement(slot.lane)),
            inverse_masses: slots.map_inline(|slot| block(slot).inverse_mass(slot.lane)),
        }
    }

    /// Moves a corner, and adds a displacement to its motion (m). Adds the impulse on the collider, which has its origin
    /// there (m). Returns the distance.
    #[inline]
    pub fn push(
        &self,
        corner: usize,
        particles: &mut ClothParticles,
        [push, displacement]: [Vec3; 2],
        (given, origin): (&mut Impulse, Vec3),
    ) -> f32 {
        let Slot { block, lane } = self.slots[corner];
        let block = &mut particles.blocks_mut()[block];
        let pushed = self.positions[corner] + push;
        block.set_position(lane, pushed);
        block.set_displacement(lane, self.displacements[corner] + displacement);
        given.add(pushed - origin, displacement, self.inverse_masses[corner]);
        push.length()
    }

    /// The push of each corner relative to that of the point with these weights: by its weight and its inverse mass.
    /// `None` if none can move.
    #[inline]
    pub fn shares(&self, weights: [f32; 3]) -> Option<[f32; 3]> {
        let parts = [0, 1, 2].map_inline(|corner| weights[corner] * self.inverse_masses[corner]);
        let mobility: f32 = (0..3).map(|corner| weights[corner] * parts[corner]).sum();
        // A corner with a tiny weight beside pins cannot make up for them: it would be thrown away.
        let mobility = mobility.max(parts[0].max(parts[1]).max(parts[2]) / MAX_SHARE);
        (mobility != 0.0).then(|| parts.map_inline(|part| part / mobility))
    }

    /// Positions at a fraction of the sub-step.
    #[inline]
    fn when(&self, part: f32) -> [Vec3; 3] {
        [0, 1, 2]
            .map_inline(|corner| self.positions[corner] - self.displacements[corner] * (1.0 - part))
    }
}

/// The contact of a triangle.
pub(crate) struct Touching {
    pub weights: [f32; 3],
    pub normal: Vec3,
    /// The core's point (m).
    pub centre: Vec3,
    /// Penetration along the normal (m), negative outside.
    pub depth: f32,
    /// Whether the sweep found it, on a path longer than half of the reach.
    pub is_swept: bool,
}

/// A ball's or a capsule's motion in a sub-step, for tests against triangles.
pub(crate) struct CoreMotion<'a> {
    pub of: ColliderSubstep<'a>,
    pub lanes: LaneMotion,
    /// Distance from the core at which it touches (m).
    pub reach: f32,
    /// The core at the end of the sub-step.
    pub at_end: [Vec3; 2],
}

impl<'a> CoreMotion<'a> {
    pub fn new(of: ColliderSubstep<'a>, lanes: LaneMotion) -> Self {
        Self {
            of,
            lanes,
            reach: of.collider.shape.radius().unwrap_or(0.0) + lanes.particle_radius,
            at_end: segment(of.collider, of.pose),
        }
    }

    /// The smallest distance of a particle's faces from a touch (m), and their largest displacement relative to the
    /// collider in the sub-step (m). `corners` are the corners of all faces, and `own` is the particle.
    #[inline]
    pub fn clearance(&self, blocks: &[Block], own: Slot, corners: &[Slot]) -> [f32; 2] {
        let first = blocks[own.block].position(own.lane);
        let (mut edge, mut speed) = (0.0_f32, 0.0_f32);
        for &Slot { block, lane } in corners {
            let block = &blocks[block];
            edge = edge.max(block.position(lane).distance_squared(first));
            speed = speed.max(block.displacement(lane).distance_squared(self.of.slide));
        }
        let clear = self.clearance_of(first, edge.sqrt());
        [clear, speed.sqrt() + self.of.swing]
    }

    /// The smallest distance from a touch of what is within `extent` of a point (m).
    #[inline]
    fn clearance_of(&self, point: Vec3, extent: f32) -> f32 {
        let [start, end] = self.at_end;
        let along = end - start;
        let part = ((point - start).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let beside = start + along * part;
        // A core of zero length is its first end.
        let nearest = if part > 0.0 { beside } else { start };
        // Larger by rounding errors and by the tolerance of a touch.
        let near = (1.0 + 4.0e-3) * self.reach + extent;
        let rounding = 1.0e-5 * (near + point.length());
        point.distance(nearest) - near - rounding
    }

    /// The contact of a triangle at the end of the sub-step or at its first hit.
    pub fn touch(&self, corners: &Corners) -> Option<Touching> {
        let reach = self.reach;
        let segment = |part: f32| segment(self.of.collider, self.of.pose_at(part));
        let touching = |nearest: NearestPoints, [start, end]: [Vec3; 2], triangle: [Vec3; 3]| {
            let (normal, distance) = match nearest.offset.length() {
                0.0 => (face_normal(triangle, start.midpoint(end)), 0.0),
                distance => (nearest.offset / distance, distance),
            };
            Touching {
                weights: nearest.weights,
                normal,
                centre: start.lerp(end, nearest.along),
                depth: reach - distance,
                is_swept: false,
            }
        };
        let speed = self.of.speed(corners.displacements);
        let [a, b, c] = corners.positions;
        let middle = (a + b + c) / 3.0;
        let extent = (a.distance_squared(middle).max(b.distance_squared(middle)))
            .max(c.distance_squared(middle));
        if self.clearance_of(middle, extent.sqrt()) > speed {
            return None;
        }
        let nearest_at_end = nearest(corners.positions, self.at_end);
        // Most candidates are too far away for a hit.
        let distance = nearest_at_end.offset.length();
        if distance.is_nan() || distance - speed > reach {
            return None;
        }
        // A triangle that moved less than half of the reach, and is not nearer, is still on its original side.
        let is_plain = speed <= reach / 2.0 && distance >= reach / 2.0;
        if self.lanes.is_swept && !is_plain && speed.is_finite() {
            let tolerance = 1.0e-3 * reach;
            let hit = first_touch(speed, reach, tolerance, |part| {
                nearest(corners.when(part), segment(part)).offset.length()
            });
            if let Some(part) = hit {
                let (triangle, core) = (corners.when(part), segment(part));
                let mut touch = touching(nearest(triangle, core), core, triangle);
                touch.is_swept = speed > reach / 2.0;
                // The position that it would have, had it moved on with the surface.
                (touch.centre, touch.normal) = self.of.carry(part, touch.centre, touch.normal);
                let offset = at(corners.positions, touch.weights) - touch.centre;
                touch.depth = reach - touch.normal.dot(offset);
                if touch.depth > 0.0 {
                    return Some(touch);
                }
            }
        }
        Some(touching(nearest_at_end, self.at_end, corners.positions))
    }
}

/// The core of a ball or a capsule in a pose.
fn segment(collider: &MovingCollider, pose: Isometry3d) -> [Vec3; 2] {
    match collider.shape.core(pose).0 {
        Core::Point(centre) => [centre; 2],
        Core::Segment(ends) => ends,
        Core::Cuboid { .. } | Core::HalfSpace { .. } => [Vec3::NAN; 2],
    }
}

/// Normal of a triangle that contains the core's point, away from the core's middle.
#[inline]
fn face_normal([a, b, c]: [Vec3; 3], middle: Vec3) -> Vec3 {
    let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
    let is_inwards = normal.dot(a - middle) < 0.0;
    if is_inwards { -normal } else { normal }
}

/// Whether a probe meets a triangle that any of the `found` particles owns, at the current positions. For a box or a
/// half-space, whether any particle was found.
pub fn meets_triangles(
    surface: &Surface,
    particles: &ClothParticles,
    found: &[u32],
    probe: &Probe,
) -> bool {
    let segment = match probe.core {
        Core::Point(centre) => [centre; 2],
        Core::Segment(ends) => ends,
        Core::Cuboid { .. } | Core::HalfSpace { .. } => return !found.is_empty(),
    };
    let reach = probe.reach() as f32;
    let owners = found.iter();
    let mut faces = owners.flat_map(|&owner| surface.faces().of(owner));
    faces.any(|face| {
        let corners = face.map_inline(|corner| particles.position_at(corner as usize));
        nearest(corners, segment).offset.length_squared() < reach * reach
    })
}
