//! Tests of triangles against sharp edges and corners of a shape, which pass between particles.
//!
//! A triangle whose corners are all outside a solid can only intersect it where one of the solid's edges passes through
//! the triangle. So only edges are tested beside the particles, and nothing for flat surfaces.

use bevy::math::{Affine3A, Vec3};

use super::{
    edge_contact::{EdgeContact, NearEdge},
    fan_view::FanView,
    shape_memory::{Nearness, ShapeMemory},
};
use crate::{
    cloth::{ClothParticles, Fan, MapInline, Slot, Surface},
    contact::{
        candidates::{Candidate, Guard},
        colliders::{ColliderSubstep, at},
        friction::{Contact, Impulse, first_touch},
        particles::{ContactResult, LaneMotion, ParticlesNearEdges},
        triangles::Corners,
    },
};

/// A triangle that the plane of a box's face keeps off by this fraction of the distance at which edges touch is not tested:
/// particles keep it there, even if they sink in by a little before they are pushed out.
const FLAT: f32 = 0.9;
/// Smallest distance of triangles from edges for particles without a radius, in spacings.
const SKIN: f32 = 0.02;
/// Edges are remembered up to this fraction of a spacing beyond a triangle's reach, or up to the reach itself.
const SLACK: f32 = 0.25;
/// Largest side of a triangle, in spacings: a diagonal of a grid, stretched by 6 %.
const SIDE: f32 = 1.5;

/// No candidate.
pub(crate) const NONE: u32 = u32::MAX;

/// A shape's motion in a sub-step, for tests of triangles against its edges.
pub(crate) struct EdgeMotion<'a> {
    of: ColliderSubstep<'a>,
    lanes: &'a LaneMotion,
    /// A triangle that moves farther in the sub-step may have passed an edge (m).
    fast: f32,
    near: Nearness,
    /// To its frame at the end.
    to_local: Affine3A,
}

impl<'a> EdgeMotion<'a> {
    /// On a cloth with a spacing (m), in a tick.
    pub fn new(pushing: &ParticlesNearEdges<'a>, spacing: f32, tick: u32) -> Self {
        let particle_radius = pushing.lanes.particle_radius;
        let reach = particle_radius.max(SKIN * spacing);
        Self {
            of: pushing.motion,
            lanes: pushing.lanes,
            fast: reach / 2.0,
            near: Nearness {
                reach,
                slack: reach.max(SLACK * spacing),
                smooth: (SIDE * spacing).powi(2) / (6.0 * particle_radius),
                tick,
                substep: pushing.motion.substep.index,
            },
            to_local: pushing.motion.pose.inverse().into(),
        }
    }

    /// Displacement relative to the shape for the swept test (m); 0 without one.
    #[inline]
    fn swept(&self, speed: f32) -> f32 {
        let is_fast = self.lanes.is_swept && speed > self.fast && speed.is_finite();
        if is_fast { speed } else { 0.0 }
    }

    /// The nearest edge at the first contact of a fast triangle.
    fn hit(&self, corners: &Corners) -> Option<(Vec3, Vec3)> {
        let speed = self.swept(self.of.speed(corners.displacements));
        if speed == 0.0 {
            return None;
        }
        let Nearness { reach, smooth, .. } = self.near;
        let around = speed + reach;
        let closest = |part: f32| {
            let pose = self.of.pose_at(part);
            let triangle = [0, 1, 2].map_inline(|corner| {
                let gone = corners.displacements[corner] * (1.0 - part);
                pose.inverse() * (corners.positions[corner] - gone)
            });
            NearEdge::of(&self.of.collider.shape, triangle, around, [reach, smooth])
        };
        // For an edge that cut the triangle already, the original side is unknown.
        if closest(0.0).is_close {
            return None;
        }
        let tolerance = 1.0e-2 * reach;
        let part = first_touch(speed, reach, tolerance, |part| closest(part).distance)?;
        let (edge, pose) = (closest(part), self.of.pose_at(part));
        let normal = edge.offset.try_normalize()?;
        Some((self.of).carry(part, pose * edge.centre, pose.rotation * normal))
    }
}

/// Pushes triangles off the edges of a shape that pass through them. Moves their corners by their weights and their
/// inverse masses.
pub(crate) fn push_off_edges(
    particles: &mut ClothParticles,
    pushing: &mut ParticlesNearEdges,
    surface: &Surface,
    (first, clear, near_edges): (usize, &mut [f32], &mut [u32]),
    (guard, view, memory): (&mut Guard, &mut FanView, &mut ShapeMemory),
    motion: &EdgeMotion,
) -> ContactResult {
    memory.match_reach(motion.near);
    let mut edges = OffEdges {
        pushing,
        motion,
        guard,
        view,
        found: ContactResult::default(),
        farthest: 0.0,
    };
    let count = near_edges.len();
    let (mut at, mut kept) = (0, 0);
    // After motion that nobody expected, all others are looked at, too.
    let mut all = edges.guard.is_outrun().then_some(0);
    loop {
        let index = all.unwrap_or_else(|| {
            let number = near_edges.get(at).copied().unwrap_or(NONE);
            (number as usize).saturating_sub(first)
        });
        if index >= count {
            break;
        }
        at += 1;
        let candidate = edges.pushing.candidates[index];
        let fan = candidate.fan(surface.fans());
        if !fan.faces.is_empty() && !edges.guard.is_clear(clear[index], fan.corners) {
            let clearance = edges.push(particles, candidate, fan, memory);
            clear[index] = edges.guard.until(clearance, fan.corners);
        }
        if all.is_some() || edges.guard.is_outrun() {
            all = Some(index + 1);
        } else if !fan.faces.is_empty() && !edges.guard.is_clear_for_good(clear[index]) {
            near_edges[kept] = (first + index) as u32;
            kept += 1;
        }
    }
    if all.is_some() {
        for (number, index) in near_edges.iter_mut().zip(first..) {
            *number = index as u32;
        }
    } else if let Some(end) = near_edges.get_mut(kept) {
        *end = NONE;
    }
    edges.found.farthest_push = edges.farthest * surface.max_faces() as f32;
    edges.found
}

/// Pushes triangles off edges in a sub-step.
struct OffEdges<'a, 'b> {
    pushing: &'a mut ParticlesNearEdges<'b>,
    motion: &'a EdgeMotion<'a>,
    guard: &'a mut Guard,
    view: &'a mut FanView,
    found: ContactResult,
    /// Largest push by one triangle (m).
    farthest: f32,
}

impl OffEdges<'_, '_> {
    /// Pushes the triangles that a candidate owns. Returns the displacement of everything before one of them can touch
    /// an edge (m); 0 if one does.
    fn push(
        &mut self,
        particles: &mut ClothParticles,
        candidate: Candidate,
        fan: Fan,
        memory: &mut ShapeMemory,
    ) -> f32 {
        let (motion, near) = (self.motion, self.motion.near);
        let is_pinned = |slot: &Slot| particles.blocks()[slot.block].inverse_mass(slot.lane) == 0.0;
        if self.pushing.has_hidden && fan.corners.iter().all(is_pinned) {
            return 0.0;
        }
        let to_local = &motion.to_local;
        (self.view).look(particles.blocks(), fan.corners, to_local, &motion.of);
        let shape = &motion.of.collider.shape;
        let gap = shape.gap(&self.view.corners) - FLAT * near.reach;
        let clearance = gap.max(memory.clearance(candidate.particle, self.view, near));
        if clearance > motion.swept(self.view.speed) {
            return clearance;
        }
        let faces = memory.faces(candidate.particle, fan);
        let mut clearance = f32::INFINITY;
        for (&face, known) in fan.faces.iter().zip(faces) {
            let triangle = self.view.triangle(face);
            let speed = motion.swept(self.view.speed);
            let gap = shape.gap(&triangle) - FLAT * near.reach;
            let moved = known.moved(triangle);
            let left = gap.max(known.clearance - moved);
            if left > speed {
                clearance = clearance.min(left);
                continue;
            }
            let slots = fan.slots(face);
            let hit = if speed > 0.0 {
                motion.hit(&Corners::of(particles, slots))
            } else {
                None
            };
            let given = &mut self.found.given;
            let (index, slot) = self.pushing.place(&candidate);
            // That of the particle that owns the triangle.
            let friction = motion.lanes.friction * self.pushing.contacts[index].grip[slot.lane];
            let (pushed, depth) = if let Some(hit) = hit {
                let corners = Corners::of(particles, slots);
                push_in_front(particles, &corners, hit, (motion, friction), given)
            } else if let Some(contact) = known.deepest(shape, triangle, near, moved) {
                let corners = Corners::of(particles, slots);
                push_point(particles, &corners, &contact, (motion, friction), given)
            } else {
                clearance = clearance.min(known.clearance).max(0.0);
                continue;
            };
            clearance = 0.0;
            for slot in slots {
                self.guard.note(slot, pushed);
            }
            (self.view).look(particles.blocks(), fan.corners, to_local, &motion.of);
            self.pushing.note_depth(index, slot.lane, depth);
            self.found.deepest = self.found.deepest.max(depth);
            self.farthest = self.farthest.max(pushed);
        }
        clearance
    }
}

/// Pushes a triangle's point along its normal. Returns the largest displacement of a corner and the depth (m).
fn push_point(
    particles: &mut ClothParticles,
    corners: &Corners,
    contact: &EdgeContact,
    (motion, friction): (&EdgeMotion, f32),
    given: &mut Impulse,
) -> (f32, f32) {
    let (weights, depth) = (contact.weights, contact.depth);
    let normal = motion.of.pose.rotation * contact.normal;
    let Some(shares) = corners.shares(weights) else {
        return (0.0, depth);
    };
    let point = [corners.positions, corners.displacements].map_inline(|of| at(of, weights));
    let contact = Contact::of(&motion.of, point, (normal, depth), motion.near.reach);
    let push = contact.push(friction, &motion.lanes.push_out);
    let mut farthest = 0.0_f32;
    for (corner, share) in shares.into_iter().enumerate() {
        if share > 0.0 {
            let push = push.map_inline(|by| by * share);
            let by = (&mut *given, motion.of.origin);
            farthest = farthest.max(corners.push(corner, particles, push, by));
        }
    }
    (farthest, depth)
}

/// Pushes each corner of a triangle in front of the plane at its hit. Returns the largest displacement and the depth
/// (m).
fn push_in_front(
    particles: &mut ClothParticles,
    corners: &Corners,
    (centre, normal): (Vec3, Vec3),
    (motion, friction): (&EdgeMotion, f32),
    given: &mut Impulse,
) -> (f32, f32) {
    let (mut farthest, mut deepest) = (0.0_f32, 0.0_f32);
    for corner in 0..3 {
        let position = corners.positions[corner];
        let depth = motion.near.reach - normal.dot(position - centre);
        if depth <= 0.0 || corners.inverse_masses[corner] == 0.0 {
            continue;
        }
        let point = [position, corners.displacements[corner]];
        let contact = Contact::of(&motion.of, point, (normal, depth), motion.near.reach);
        let push = contact.push(friction, &motion.lanes.push_out);
        deepest = deepest.max(depth);
        let by = (&mut *given, motion.of.origin);
        farthest = farthest.max(corners.push(corner, particles, push, by));
    }
    (farthest, deepest)
}
