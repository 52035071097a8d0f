//! Particles against the planes of a shape's surface nearest to them, for shapes whose nearest point is expensive.
//!
//! A particle's distance is a statement about positions: having moved by less since, it cannot touch, however much time
//! has passed. From a surface that deforms, it is one about the rest of the tick. One that touched is tested against the same plane while it hardly moves, in that tick.

use bevy::math::{Mat3, Vec3};
use multiversion::multiversion;

use super::{
    lanes::{LaneMotion, Sums, is_clear, push, survey},
    near::Near,
};
use crate::{
    cloth::{Block, LANES, Lanes, MapInline, View, W, X, Y, Z},
    contact::{
        candidates::ContactBlock,
        colliders::{ColliderShape, ColliderSubstep},
    },
};

/// A particle that has moved less than this fraction of its radius is tested against the last plane. For a flat surface
/// that is exact; another part of a mesh may be nearer by at most twice as much.
const SAME_PLANE: f32 = 0.1;

/// The planes nearest to eight particles, in the shape's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Planes {
    /// Where each particle was when its plane was found (m); NaN before.
    at: [Lanes; 3],
    /// Its distance then (m), and the plane's normal.
    distance: Lanes,
    normal: [Lanes; 3],
    /// Displacement of the surface there in the tick, in a shape that deforms (m), and the fraction of the tick at which it was
    /// found.
    surface: [Lanes; 3],
    since: Lanes,
    /// Displacement up to which the plane is reused (m); negative if the particle did not touch it in this tick.
    same: Lanes,
    /// The tick of that.
    tick: u32,
}

/// A shape's frame at the end of a sub-step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    centre: [f32; 3],
    axes: [[f32; 3]; 3],
    /// Radius of a particle, and its displacement up to which a plane is reused (m).
    reach: f32,
    same: f32,
    /// The fraction of the tick that has passed, and that of the sub-step.
    passed: f32,
    part: f32,
    /// Largest displacement of the surface by deformation, in the sub-step and in the tick (m).
    deformation: f32,
    farthest_move: f32,
    tick: u32,
}

impl Planes {
    pub const UNKNOWN: Self = Self {
        at: [[f32::NAN; LANES]; 3],
        distance: [f32::INFINITY; LANES],
        normal: [[0.0; LANES], [1.0; LANES], [0.0; LANES]],
        surface: [[0.0; LANES]; 3],
        since: [0.0; LANES],
        same: [-1.0; LANES],
        tick: 0,
    };

    /// Finds the plane nearest to a particle.
    fn find(&mut self, lane: usize, shape: &ColliderShape, local: Vec3, frame: &Frame) {
        let known = Vec3::from([0, 1, 2].map_inline(|axis| self.at[axis][lane]));
        let within = self.distance[lane].abs() + local.distance(known);
        let within = within * (1.0 + 1.0e-3) + 1.0e-3;
        let (nearest, surface) = match shape {
            ColliderShape::Deforming(mesh) => mesh.moving_nearest(frame.passed, local),
            shape => (shape.nearest_within(local, within), Vec3::ZERO),
        };
        let is_touching = nearest.distance <= frame.reach;
        let beside = match shape {
            _ if is_touching => f32::INFINITY,
            ColliderShape::Deforming(mesh) => mesh.clearance(frame.passed, local, surface),
            shape => shape.distance_beside_ground(local),
        };
        self.distance[lane] = nearest.distance.min(beside);
        self.same[lane] = if is_touching { frame.same } else { -1.0 };
        self.since[lane] = frame.passed;
        for axis in 0..3 {
            self.at[axis][lane] = local[axis];
            self.normal[axis][lane] = nearest.normal[axis];
            self.surface[axis][lane] = surface[axis];
        }
    }

    /// Clears the positions of those that are not reused.
    #[cfg(test)]
    pub fn forget(&mut self) {
        for lane in (0..LANES).filter(|&lane| self.same[lane] < 0.0) {
            self.at[0][lane] = f32::NAN;
        }
    }
}

impl Frame {
    pub fn new(of: &ColliderSubstep, particle_radius: f32, tick: u32) -> Self {
        let pose = of.pose;
        Self {
            centre: Vec3::from(pose.translation).to_array(),
            axes: Mat3::from_quat(pose.rotation).to_cols_array_2d(),
            reach: particle_radius,
            same: SAME_PLANE * particle_radius,
            passed: of.substep.end(),
            part: 1.0 / of.substep.count as f32,
            deformation: of.deformation,
            farthest_move: of.collider.shape.deformation(),
            tick,
        }
    }

    /// Whether the surface moves in this frame.
    fn deforms(&self) -> bool {
        self.deformation > 0.0
    }
}

/// A particle relative to its plane.
struct Moved {
    /// Its position in the shape's frame (m).
    at: [f32; 3],
    /// Its displacement since its plane was found, relative to that (m).
    offset: [f32; 3],
    /// Lower bound of its distance (m).
    least: f32,
    /// Whether it is tested against its last plane.
    is_same: bool,
}

#[inline(always)]
fn moved<const DEFORMS: bool>(view: &View, planes: &Planes, frame: &Frame, l: usize) -> Moved {
    let [cx, cy, cz] = frame.centre;
    let (x, y, z) = (view[X + l] - cx, view[Y + l] - cy, view[Z + l] - cz);
    let at = frame.axes.map_inline(|[u, v, w]| x * u + y * v + z * w);
    let mut known = [planes.at[0][l], planes.at[1][l], planes.at[2][l]];
    let mut is_recent = true;
    if DEFORMS {
        let passed = frame.passed - planes.since[l];
        known[0] += planes.surface[0][l] * passed;
        known[1] += planes.surface[1][l] * passed;
        known[2] += planes.surface[2][l] * passed;
        // Since then, no other part of the surface has come nearer by more than a particle's radius.
        is_recent = 2.0 * frame.farthest_move * passed.abs() <= frame.reach;
    }
    let offset = [at[0] - known[0], at[1] - known[1], at[2] - known[2]];
    let [a, b, c] = offset;
    let length = (a * a + b * b + c * c).sqrt();
    let distance = planes.distance[l];
    // Smaller by rounding errors: whether a particle is tested must not depend on where its plane was found.
    let size = at[0].abs() + at[1].abs() + at[2].abs() + distance.abs();
    Moved {
        at,
        offset,
        least: distance - length * (1.0 + 1.0e-5) - 2.0e-6 * size,
        is_same: (length <= planes.same[l]) & is_recent,
    }
}

/// Bit mask of the particles that may touch the shape, but not their last planes.
#[inline(always)]
fn stale<const DEFORMS: bool>(view: &View, planes: &Planes, frame: &Frame) -> u8 {
    let mut is_stale = [0_u32; LANES];
    for l in 0..LANES {
        let moved = moved::<DEFORMS>(view, planes, frame, l);
        // Both false for NaN.
        let is_far = moved.least > frame.reach;
        let is_same = moved.is_same;
        let is_free = view[W + l] > 0.0;
        is_stale[l] = if !is_far & !is_same & is_free { 1 } else { 0 };
    }
    (0..LANES).fold(0, |mask, l| mask | (is_stale[l] as u8) << l)
}

/// Finds the planes nearest to the particles that need new ones.
pub(crate) fn find_planes(
    blocks: &[Block],
    contacts: &[ContactBlock],
    planes: &mut [Planes],
    (shape, frame, motion): (&ColliderShape, &Frame, &LaneMotion),
) {
    for contact in contacts {
        if contact.lanes == 0 || is_clear(contact, motion) {
            continue;
        }
        let planes = &mut planes[contact.block as usize];
        if planes.tick != frame.tick {
            if frame.deforms() {
                *planes = Planes::UNKNOWN;
            }
            (planes.same, planes.tick) = ([-1.0; LANES], frame.tick);
        }
        let view = blocks[contact.block as usize].view();
        let is_stale = match frame.deforms() {
            true => stale::<true>(view, planes, frame),
            false => stale::<false>(view, planes, frame),
        };
        let mask = is_stale & contact.lanes;
        for lane in (0..LANES).filter(|lane| mask & (1 << lane) != 0) {
            let at = moved::<false>(view, planes, frame, lane).at;
            planes.find(lane, shape, at.into(), frame);
        }
    }
}

#[inline(always)]
fn near_planes<const DEFORMS: bool>(view: &View, planes: &Planes, frame: &Frame) -> Near {
    let mut near = Near::NONE;
    let [u, v, w] = frame.axes;
    for l in 0..LANES {
        let moved = moved::<DEFORMS>(view, planes, frame, l);
        let [a, b, c] = moved.offset;
        let normal = &planes.normal;
        let (na, nb, nc) = (normal[0][l], normal[1][l], normal[2][l]);
        let is_same = moved.is_same;
        let depth = frame.reach - (planes.distance[l] + na * a + nb * b + nc * c);
        near.depth[l] = if is_same { depth } else { f32::NEG_INFINITY };
        // Another part may be nearer than the plane.
        near.bound[l] = frame.reach - moved.least;
        near.offset[0][l] = u[0] * na + v[0] * nb + w[0] * nc;
        near.offset[1][l] = u[1] * na + v[1] * nb + w[1] * nc;
        near.offset[2][l] = u[2] * na + v[2] * nb + w[2] * nc;
        near.length[l] = 1.0;
        if DEFORMS {
            let is_known = is_same | (moved.least > frame.reach);
            near.swing[l] = if is_known { 0.0 } else { frame.deformation };
            let (a, b, c) = (
                planes.surface[0][l] * frame.part,
                planes.surface[1][l] * frame.part,
                planes.surface[2][l] * frame.part,
            );
            near.surface[0][l] = u[0] * a + v[0] * b + w[0] * c;
            near.surface[1][l] = u[1] * a + v[1] * b + w[1] * c;
            near.surface[2][l] = u[2] * a + v[2] * b + w[2] * c;
        }
    }
    near
}

/// Pushes the particles of blocks out of the half-spaces below their planes.
#[multiversion(targets("x86_64+avx+avx2"))]
pub(crate) fn push_planes(
    blocks: &mut [Block],
    contacts: &mut [ContactBlock],
    planes: &[Planes],
    (frame, motion): (&Frame, &LaneMotion),
    sums: &mut Sums,
) {
    push_planes_baseline(blocks, contacts, planes, (frame, motion), sums);
}

#[inline(always)]
pub(crate) fn push_planes_baseline(
    blocks: &mut [Block],
    contacts: &mut [ContactBlock],
    planes: &[Planes],
    (frame, motion): (&Frame, &LaneMotion),
    sums: &mut Sums,
) {
    let mut own = *sums;
    for contact in contacts {
        if contact.lanes == 0 || is_clear(contact, motion) {
            continue;
        }
        let block = contact.block as usize;
        let (view, planes) = (blocks[block].view_mut(), &planes[block]);
        if frame.deforms() {
            push_block::<true>(view, contact, planes, (frame, motion), &mut own);
        } else {
            push_block::<false>(view, contact, planes, (frame, motion), &mut own);
        }
    }
    *sums = own;
}

#[inline(always)]
fn push_block<const DEFORMS: bool>(
    view: &mut View,
    contact: &mut ContactBlock,
    planes: &Planes,
    (frame, motion): (&Frame, &LaneMotion),
    sums: &mut Sums,
) {
    let mut near = near_planes::<DEFORMS>(view, planes, frame);
    if survey::<DEFORMS>(view, &mut near, contact, motion, sums) {
        let of = [&contact.area, &contact.grip];
        push::<DEFORMS>(view, &near, of, motion, sums);
    }
}
