//! Pushes particles out of analytic shapes, eight at a time, in plain loops that the compiler vectorises.
//!
//! A block is tested against the collider at the end of the sub-step, and particles inside it are pushed out at once.
//! The caller handles blocks with two kinds of particles. Fast particles may have passed through; for deep particles,
//! the nearest way out may be on the other side.
//!
//! The clearance of a block is stored and compared with the largest possible displacement since, so that a clear block
//! is not tested again. So most of a cloth costs one comparison for eight particles.

use bevy::math::Vec3;
use multiversion::multiversion;

use super::near::{Cuboid, HalfSpace, Near, Round, near_cuboid, near_half_space, near_round};
use crate::{
    cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W, X, Y, Z, larger, smaller},
    contact::{candidates::ContactBlock, friction::PushOut},
};

/// Constants for all blocks of a collider in a sub-step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LaneMotion {
    /// The collider's origin (m).
    pub origin: [f32; 3],
    /// Its displacement (m) and rotation (rad) in the sub-step.
    pub slide: [f32; 3],
    pub spin: [f32; 3],
    /// Largest displacement of any point of its core by rotation alone (m).
    pub swing: f32,
    pub particle_radius: f32,
    /// Larger displacements are left to the caller (m).
    pub most: f32,
    /// Larger depths are left to the caller (m).
    pub deepest: f32,
    /// Distance at which a fast particle counts as touching (m).
    pub tolerance: f32,
    pub is_swept: bool,
    pub friction: f32,
    pub push_out: PushOut,
    /// Largest displacement of everything so far in the tick (m); of the collider alone where that of each block is
    /// measured.
    pub odometer: f32,
    /// Largest depth that counts (m).
    pub thickness: f32,
}

impl LaneMotion {
    /// Displacement of the surface in the sub-step at an arm from the collider's origin (m).
    #[inline(always)]
    pub fn of_surface(&self, [ax, ay, az]: [f32; 3]) -> [f32; 3] {
        let ([sx, sy, sz], [wx, wy, wz]) = (self.slide, self.spin);
        [
            sx + (wy * az - wz * ay),
            sy + (wz * ax - wx * az),
            sz + (wx * ay - wy * ax),
        ]
    }
}

/// Sums over all blocks, lane by lane.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Sums {
    pub deepest: Lanes,
    /// Squared (m²).
    pub farthest_push: Lanes,
    pub area: Lanes,
    pub volume: Lanes,
    /// Mass × displacement that the cloth has lost (kg m), and its moment about the collider's origin (kg m²).
    pub linear: [Lanes; 3],
    pub angular: [Lanes; 3],
    /// Number of blocks left to the caller.
    pub left: u32,
    /// Largest push of a corner by one triangle (m).
    pub passed: f32,
}

impl Sums {
    /// Adds to a lane what its particle gave (kg m) at an arm from the collider's origin (m).
    #[inline(always)]
    pub fn give(&mut self, l: usize, [gx, gy, gz]: [f32; 3], [x, y, z]: [f32; 3]) {
        self.linear[0][l] += gx;
        self.linear[1][l] += gy;
        self.linear[2][l] += gz;
        self.angular[0][l] += y * gz - z * gy;
        self.angular[1][l] += z * gx - x * gz;
        self.angular[2][l] += x * gy - y * gx;
    }
}

/// Whether no lane of a block can touch yet. False for NaN.
#[inline(always)]
pub(crate) fn is_clear(contact: &ContactBlock, motion: &LaneMotion) -> bool {
    contact.points == 0 || motion.odometer + contact.moved < contact.clear_until
}

/// Stores the depth and the clearance of a block, and returns whether to push its particles. Only surfaces that may deform
/// have a motion of their own in `near`.
#[inline(always)]
pub(crate) fn survey<const DEFORMS: bool>(
    view: &View,
    near: &mut Near,
    contact: &mut ContactBlock,
    motion: &LaneMotion,
    sums: &mut Sums,
) -> bool {
    let (mut deepest, mut size) = ([0.0_f32; LANES], [0.0_f32; LANES]);
    let mut is_unusual = [0_u32; LANES];
    for l in 0..LANES {
        let is_free = (view[W + l] > 0.0) & (contact.points & (1 << l) != 0);
        let (depth, bound) = (near.depth[l], near.bound[l]);
        let swing = if DEFORMS { near.swing[l] } else { 0.0 };
        let slow = motion.most - (motion.swing + swing);
        let slow = if slow > 0.0 { slow * slow } else { -1.0 };
        let [sx, sy, sz] = near.on_surface::<DEFORMS>(l, motion.slide);
        let (x, y, z) = (view[DX + l] - sx, view[DY + l] - sy, view[DZ + l] - sz);
        let is_fast = x * x + y * y + z * z > slow;
        let is_deep = depth > motion.deepest;
        is_unusual[l] = if is_free & (is_fast | is_deep) { 1 } else { 0 };
        near.depth[l] = if is_free { depth } else { f32::NEG_INFINITY };
        deepest[l] = if is_free { bound } else { f32::NEG_INFINITY };
        let away = view[X + l].abs() + view[Y + l].abs() + view[Z + l].abs();
        size[l] = if is_free { away } else { 0.0 };
    }
    let most = deepest.into_iter().fold(f32::NEG_INFINITY, f32::max);
    let farthest = size.into_iter().fold(0.0, f32::max);
    contact.left = 0;
    if is_unusual != [0; LANES] {
        leave_out(view, near, contact, motion, &is_unusual);
    }
    for (known, depth) in contact.depth.iter_mut().zip(near.depth) {
        *known = larger(smaller(depth, motion.thickness), *known);
    }
    // Smaller by rounding errors and by the tolerance of a touch.
    let moved = motion.odometer + contact.moved;
    let clear = -most - 2.0 * motion.tolerance - 1.0e-5 * (farthest - most + moved);
    // What has moved since the search may move back.
    contact.clear_until = motion.odometer - contact.moved + clear;
    if contact.left != 0 {
        contact.clear_until = f32::NEG_INFINITY;
        sums.left += 1;
    }
    most > 0.0
}

/// Leaves deep particles, and those that move so fast that they may have passed through, to the caller.
#[cold]
#[inline(never)]
fn leave_out(
    view: &View,
    near: &mut Near,
    contact: &mut ContactBlock,
    motion: &LaneMotion,
    is_unusual: &[u32; LANES],
) {
    for l in (0..LANES).filter(|&l| is_unusual[l] != 0) {
        let displacement = Vec3::new(view[DX + l], view[DY + l], view[DZ + l]);
        let surface = Vec3::from(near.on_surface::<true>(l, motion.slide));
        let speed = (displacement - surface).length() + (motion.swing + near.swing[l]);
        let is_met = speed > motion.most && near.bound[l] + speed > -motion.tolerance;
        if near.depth[l] > motion.deepest || (is_met && motion.is_swept) {
            contact.left |= 1 << l;
            near.depth[l] = f32::NEG_INFINITY;
        }
    }
}

/// Pushes particles out that are inside, like [`Contact::push`](crate::contact::friction::Contact::push).
#[inline(always)]
pub(crate) fn push<const DEFORMS: bool>(
    view: &mut View,
    near: &Near,
    [area, grips]: [&Lanes; 2],
    motion: &LaneMotion,
    sums: &mut Sums,
) {
    let [ox, oy, oz] = motion.origin;
    for l in 0..LANES {
        let (weight, depth) = (view[W + l], near.depth[l]);
        let is_pushed = weight > 0.0 && depth > 0.0;
        let inverse = 1.0 / near.length[l];
        let nx = near.offset[0][l] * inverse;
        let ny = near.offset[1][l] * inverse;
        let nz = near.offset[2][l] * inverse;
        let (px, py, pz) = (view[X + l], view[Y + l], view[Z + l]);
        let gap = depth - motion.particle_radius;
        let (ax, ay, az) = (px + nx * gap - ox, py + ny * gap - oy, pz + nz * gap - oz);
        let rigid = motion.of_surface([ax, ay, az]);
        let [sx, sy, sz] = near.on_surface::<DEFORMS>(l, rigid);
        let (rx, ry, rz) = (view[DX + l] - sx, view[DY + l] - sy, view[DZ + l] - sz);
        let apart = nx * rx + ny * ry + nz * rz;
        let (tx, ty, tz) = (rx - nx * apart, ry - ny * apart, rz - nz * apart);
        let (stopped, released) = motion.push_out.of_lane(depth, apart);
        let slip = (tx * tx + ty * ty + tz * tz).sqrt();
        let held = motion.friction * grips[l] * stopped;
        let grip = if slip > held { held / slip } else { 1.0 };
        let (fx, fy, fz) = (tx * grip, ty * grip, tz * grip);
        let (dx, dy, dz) = (nx * stopped - fx, ny * stopped - fy, nz * stopped - fz);
        let (mx, my, mz) = (dx + nx * released, dy + ny * released, dz + nz * released);
        let mx = if is_pushed { mx } else { 0.0 };
        let my = if is_pushed { my } else { 0.0 };
        let mz = if is_pushed { mz } else { 0.0 };
        let dx = if is_pushed { dx } else { 0.0 };
        let dy = if is_pushed { dy } else { 0.0 };
        let dz = if is_pushed { dz } else { 0.0 };
        view[X + l] = px + mx;
        view[Y + l] = py + my;
        view[Z + l] = pz + mz;
        view[DX + l] += dx;
        view[DY + l] += dy;
        view[DZ + l] += dz;
        let depth = if is_pushed { depth } else { 0.0 };
        sums.deepest[l] = larger(depth, sums.deepest[l]);
        let pushed = mx * mx + my * my + mz * mz;
        sums.farthest_push[l] = larger(pushed, sums.farthest_push[l]);
        let inside = if is_pushed { area[l] } else { 0.0 };
        sums.area[l] += inside;
        sums.volume[l] += inside * depth;
        let mass = if is_pushed { 1.0 / weight } else { 0.0 };
        let given = [-dx * mass, -dy * mass, -dz * mass];
        sums.give(l, given, [px + mx - ox, py + my - oy, pz + mz - oz]);
    }
}

/// Defines the push for one kind of shape: for the widest instructions of the machine, and for the baseline. The
/// results are equal to the last bit.
macro_rules! by_shape {
    ($($near:ident, $widest:ident, $baseline:ident: $shape:ty;)*) => {$(
        /// Pushes the particles of blocks out of the shape.
        #[multiversion(targets("x86_64+avx+avx2"))]
        pub(crate) fn $widest(
            blocks: &mut [Block],
            contacts: &mut [ContactBlock],
            shape: &$shape,
            motion: &LaneMotion,
            sums: &mut Sums,
        ) {
            $baseline(blocks, contacts, shape, motion, sums);
        }

        #[inline(always)]
        pub(crate) fn $baseline(
            blocks: &mut [Block],
            contacts: &mut [ContactBlock],
            shape: &$shape,
            motion: &LaneMotion,
            sums: &mut Sums,
        ) {
            let mut own = *sums;
            for contact in contacts {
                if is_clear(contact, motion) {
                    continue;
                }
                let view = blocks[contact.block as usize].view_mut();
                let mut near = $near(view, shape);
                if survey::<false>(view, &mut near, contact, motion, &mut own) {
                    push::<false>(view, &near, [&contact.area, &contact.grip], motion, &mut own);
                }
            }
            *sums = own;
        }
    )*};
}

by_shape! {
    near_round, push_round, push_round_baseline: Round;
    near_cuboid, push_cuboid, push_cuboid_baseline: Cuboid;
    near_half_space, push_half_space, push_half_space_baseline: HalfSpace;
}
