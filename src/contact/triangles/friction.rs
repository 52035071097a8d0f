//! Friction of triangles, at their particles: the contacts' [push](FrictionBudget) times μ is the budget of each.

use multiversion::multiversion;

use crate::{
    cloth::{Block, DX, DY, DZ, LANES, Lanes, MapInline, View, W, X, Y, Z, larger, smaller},
    contact::{
        candidates::ContactBlock,
        friction::FrictionBudget,
        particles::{LaneMotion, Sums},
    },
};

/// Decay time of an unspent budget, to 1/e (s).
const KEPT_FOR: f32 = 0.01;

/// A budget below this is empty (m).
const NONE_LEFT: f32 = 1.0e-15;

/// The axis of a ball or a capsule, which defines its surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CapsuleCore {
    pub axis: [f32; 3],
    /// Half of the length; 0 for a ball (m).
    pub half_length: f32,
    pub radius: f32,
}

/// Applies friction to the particles of a block, relative to the surface of a ball or a capsule.
#[inline(always)]
fn hold(
    view: &mut View,
    (held, grips): (&mut FrictionBudget, &Lanes),
    core: &CapsuleCore,
    motion: &LaneMotion,
    kept: f32,
    sums: &mut Sums,
) {
    let ([ox, oy, oz], [ux, uy, uz]) = (motion.origin, core.axis);
    let mut left = [0.0; LANES];
    for l in 0..LANES {
        let weight = view[W + l];
        let (px, py, pz) = (held.push[0][l], held.push[1][l], held.push[2][l]);
        let pushed = (px * px + py * py + pz * pz).sqrt();
        let is_new = pushed > 0.0;
        let [nx, ny, nz] = [0, 1, 2].map_inline(|axis| {
            let new = held.push[axis][l] / pushed;
            if is_new { new } else { held.normal[axis][l] }
        });
        let budget = held.budget[l] * kept + motion.friction * grips[l] * pushed;
        let (x, y, z) = (view[X + l] - ox, view[Y + l] - oy, view[Z + l] - oz);
        let along = x * ux + y * uy + z * uz;
        let along = smaller(along, core.half_length);
        let along = larger(along, -core.half_length);
        // Displacement of the surface at the contact.
        let ax = ux * along + nx * core.radius;
        let ay = uy * along + ny * core.radius;
        let az = uz * along + nz * core.radius;
        let [mx, my, mz] = motion.of_surface([ax, ay, az]);
        let (rx, ry, rz) = (view[DX + l] - mx, view[DY + l] - my, view[DZ + l] - mz);
        let apart = nx * rx + ny * ry + nz * rz;
        let (tx, ty, tz) = (rx - nx * apart, ry - ny * apart, rz - nz * apart);
        let slip = (tx * tx + ty * ty + tz * tz).sqrt();
        let grip = if slip > budget { budget / slip } else { 1.0 };
        let is_held = weight > 0.0 && budget > NONE_LEFT;
        let grip = if is_held { grip } else { 0.0 };
        let (fx, fy, fz) = (-tx * grip, -ty * grip, -tz * grip);
        view[X + l] += fx;
        view[Y + l] += fy;
        view[Z + l] += fz;
        view[DX + l] += fx;
        view[DY + l] += fy;
        view[DZ + l] += fz;
        let budget = budget - slip * grip;
        let is_left = is_held && budget > NONE_LEFT;
        let budget = if is_left { budget } else { 0.0 };
        left[l] = budget;
        held.normal[0][l] = nx;
        held.normal[1][l] = ny;
        held.normal[2][l] = nz;
        held.budget[l] = budget;
        let moved = fx * fx + fy * fy + fz * fz;
        sums.farthest_push[l] = larger(moved, sums.farthest_push[l]);
        let mass = if is_held { 1.0 / weight } else { 0.0 };
        let given = [-fx * mass, -fy * mass, -fz * mass];
        sums.give(l, given, [x + fx, y + fy, z + fz]);
    }
    held.push = [[0.0; LANES]; 3];
    held.is_active = left.into_iter().any(|left| left > 0.0);
}

/// Applies friction to everything that contacts have pushed.
#[multiversion(targets("x86_64+avx+avx2"))]
pub(crate) fn hold_all(
    blocks: &mut [Block],
    contacts: &[ContactBlock],
    budgets: &mut [FrictionBudget],
    core: &CapsuleCore,
    motion: &LaneMotion,
    seconds: f32,
    sums: &mut Sums,
) {
    hold_all_baseline(blocks, contacts, budgets, core, motion, seconds, sums);
}

#[inline(always)]
pub(crate) fn hold_all_baseline(
    blocks: &mut [Block],
    contacts: &[ContactBlock],
    budgets: &mut [FrictionBudget],
    core: &CapsuleCore,
    motion: &LaneMotion,
    seconds: f32,
    sums: &mut Sums,
) {
    // Not an exponential function: its rounding differs between instruction sets.
    let kept = KEPT_FOR / (KEPT_FOR + seconds);
    let mut own = *sums;
    for (contact, held) in contacts.iter().zip(budgets) {
        if held.is_active {
            let view = blocks[contact.block as usize].view_mut();
            hold(view, (held, &contact.grip), core, motion, kept, &mut own);
        }
    }
    *sums = own;
}
