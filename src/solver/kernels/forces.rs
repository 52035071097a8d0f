//! Forces on particles: the air's on the face of each, and the share of all in each sub-step.
//!
//! # The floor
//! A pass over eight particles needs three roots and two divisions, which take a core with AVX2 some 45 cycles. It also
//! needs some 80 additions and multiplications, two per cycle. A sub-step adds 14 of these and six loads.

use super::{barrier::one_block_at_a_time, each::three, pentadiagonal::Vec3Lanes};
use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W, X};

/// The action of forces on eight particles until their next evaluation: an acceleration of `push − drag (drag · v)` at the
/// velocity v. Both are 0 for pins.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct LinearForce {
    /// x, y and z (m/s²).
    pub push: Vec3Lanes,
    /// Along the normal, the root of the damping rate (1/√s).
    pub drag: Vec3Lanes,
}

impl LinearForce {
    pub const NONE: Self = Self {
        push: [[0.0; LANES]; 3],
        drag: [[0.0; LANES]; 3],
    };
}

/// Values that are the same for all particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AeroCoefficients {
    /// `ρ C_d` (kg/m³).
    pub drag: f32,
    /// `ρ C_l ⁄ 2` (kg/m³).
    pub lift: f32,
    /// Gauge pressure (Pa).
    pub pressure: f32,
    /// Length of a sub-step (s), and one over it (1/s).
    pub substep: f32,
    pub inverse_substep: f32,
}

/// Lower bound of the squares of normals, for faces without an area (m⁴).
const NO_AREA: f32 = f32::MIN_POSITIVE;

/// The air does not act on a particle that it would push harder (m/s²). Particles 10¹⁰ m apart have areas whose squares overflow.
const STRONGEST: f32 = 1.0e25;

/// Nor on one of no more than this inverse mass (1/kg): on pins, and on masses that overflow.
const HEAVIEST: f32 = 1.0e-30;

/// The air's action on eight particles with these areas (normals as long as the area, m²) in these winds (m/s), and the
/// position of each along its drag, for [`force_impulse`].
#[inline(always)]
fn linearize(
    view: &View,
    area: &Vec3Lanes,
    wind: &Vec3Lanes,
    coefficients: &AeroCoefficients,
    linearized: &mut LinearForce,
    place: &mut Lanes,
) {
    for l in 0..LANES {
        let normal = [area[0][l], area[1][l], area[2][l]];
        let moved = [view[DX + l], view[DY + l], view[DZ + l]];
        let v = three(|axis| moved[axis] * coefficients.inverse_substep);
        let u = [wind[0][l] - v[0], wind[1][l] - v[1], wind[2][l] - v[2]];
        let square = dot(normal, normal);
        let square = if square > NO_AREA { square } else { NO_AREA };
        let inverse = 1.0 / square.sqrt();
        let n = three(|axis| normal[axis] * inverse);
        let along = dot(u, n);
        let across = dot(u, u) - along * along;
        let across = if across > 0.0 { across.sqrt() } else { 0.0 };
        // Of the area over the mass; 0 for a pin, and for a lane that holds no particle.
        let light = square * inverse * view[W + l];
        let (lift, drag) = (
            coefficients.lift * across * light,
            coefficients.drag * along.abs() * light,
        );
        // The slope of the force over the speed, at most what one sub-step takes away.
        let rate = lift + drag;
        let most = rate * coefficients.substep;
        let allowed = 1.0 / if most > 1.0 { most } else { 1.0 };
        let rate = rate * allowed;
        let force = (lift + 0.5 * drag) * allowed * along + rate * dot(v, n);
        let root = rate.sqrt();
        let pressed = coefficients.pressure * view[W + l];
        let push = three(|axis| n[axis] * force + pressed * normal[axis]);
        // Not so if it is NaN.
        let is_pushed = push[0].abs() + push[1].abs() + push[2].abs() < STRONGEST;
        let acts = is_pushed & (view[W + l] > HEAVIEST);
        for axis in 0..3 {
            linearized.push[axis][l] = if acts { push[axis] } else { 0.0 };
            linearized.drag[axis][l] = if acts { n[axis] * root } else { 0.0 };
        }
        place[l] = place_along(view, linearized, l);
    }
}

/// Position of a particle along its drag, at the start of its last displacement. The difference of two is the sum of
/// the displacements at the start of sub-steps.
#[inline(always)]
fn place_along(view: &View, linearized: &LinearForce, l: usize) -> f32 {
    let drag = three(|axis| linearized.drag[axis][l]);
    let was = three(|axis| view[X + axis * LANES + l] - view[DX + axis * LANES + l]);
    dot(drag, was)
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The air's action on the particles of some blocks.
#[inline(always)]
pub(crate) fn air_linearize(
    blocks: &[Block],
    areas: &[Vec3Lanes],
    winds: &[Vec3Lanes],
    coefficients: &AeroCoefficients,
    linearized: &mut [LinearForce],
    places: &mut [Lanes],
) {
    let of = blocks.iter().zip(areas).zip(winds);
    for (((block, area), wind), (linearized, place)) in of.zip(linearized.iter_mut().zip(places)) {
        linearize(block.view(), area, wind, coefficients, linearized, place);
        one_block_at_a_time();
    }
}

/// Adds to `sum` the impulse (N s) that forces have given the particles of some blocks since their evaluation, `seconds` ago.
#[inline(always)]
pub(crate) fn force_impulse(
    blocks: &[Block],
    linearized: &[LinearForce],
    places: &[Lanes],
    seconds: f32,
    sum: &mut Vec3Lanes,
) {
    for ((block, linearized), place) in blocks.iter().zip(linearized).zip(places) {
        let view = block.view();
        for l in 0..LANES {
            let drag = three(|axis| linearized.drag[axis][l]);
            let moved = place_along(view, linearized, l) - place[l];
            let is_free = view[W + l] > HEAVIEST;
            let mass = 1.0 / if is_free { view[W + l] } else { 1.0 };
            for axis in 0..3 {
                let given = mass * (linearized.push[axis][l] * seconds - drag[axis] * moved);
                sum[axis][l] += if is_free { given } else { 0.0 };
            }
        }
        one_block_at_a_time();
    }
}

/// The acceleration (m/s²) of one lane that moved by this in a sub-step (m).
#[inline(always)]
pub(crate) fn acceleration(
    linearized: &LinearForce,
    moved: [f32; 3],
    inverse_substep: f32,
    l: usize,
) -> [f32; 3] {
    let drag = three(|axis| linearized.drag[axis][l]);
    let slowed = dot(drag, moved) * inverse_substep;
    three(|axis| linearized.push[axis][l] - drag[axis] * slowed)
}

/// Adds the share of forces to displacements, with this weight (s²).
#[inline(always)]
pub(crate) fn force_push(
    row: &mut [Block],
    linearized: &[LinearForce],
    weight: f32,
    inverse_substep: f32,
) {
    for (block, linearized) in row.iter_mut().zip(linearized) {
        let view = block.view_mut();
        for l in 0..LANES {
            let moved = [view[DX + l], view[DY + l], view[DZ + l]];
            let [x, y, z] = acceleration(linearized, moved, inverse_substep, l);
            view[DX + l] += weight * x;
            view[DY + l] += weight * y;
            view[DZ + l] += weight * z;
        }
        one_block_at_a_time();
    }
}
