//! The arithmetic of a sub-step on blocks of eight particles, in plain loops that the compiler vectorises.
//!
//! No operation is fused or reordered from lane to lane, so every instruction set gives the same bits.
//!
//! # The floor
//! A spring asks for one division and no square root ([`relax`]): 34 additions, subtractions and
//! multiplications of eight lanes, 15 loads and 6 stores. A core that starts two or three of the former a cycle
//! and a division of eight lanes every five cycles needs 13 to 17 cycles for eight springs, 0.6 to 0.75 ns a
//! spring at 2.8 GHz. Memory is no limit: a sub-step reads and writes each block of 256 bytes once, 32 bytes a
//! particle, since all stages follow each other down the rows while these are in the first cache.

use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W, X, Y, Z};

/// Moves the ends of eight springs towards their rest lengths, in inverse proportion to their masses: the XPBD
/// distance constraint `λ = −C / (w_a + w_b + α/Δt²)` with one sweep a sub-step (Macklin et al. 2016, 2019).
///
/// Position + displacement is where a particle is during a sweep, and only the displacement is changed: it never
/// sees the rounding of the position.
///
/// With q the squared length and r the rest length, C over the length, `1 − r/√q`, is taken as
/// `(q − r²) / (1.5 q + 0.5 r²)`, the first step of Halley's iteration for the root. At a stretch ε it is off by
/// the part ε²/4 of the correction (6·10⁻⁴ at 5 %), never too strong in a stretched spring, and finite where
/// the ends coincide.
#[inline(always)]
pub(super) fn relax(
    a: &mut View,
    b: &mut View,
    rest_square: impl Fn(usize) -> f32,
    softness: &Lanes,
) {
    for l in 0..LANES {
        let x = (b[X + l] - a[X + l]) + (b[DX + l] - a[DX + l]);
        let y = (b[Y + l] - a[Y + l]) + (b[DY + l] - a[DY + l]);
        let z = (b[Z + l] - a[Z + l]) + (b[DZ + l] - a[DZ + l]);
        let q = x * x + y * y + z * z;
        let r2 = rest_square(l);
        let weight = a[W + l] + b[W + l] + softness[l];
        let share = (q - r2) / ((1.5 * q + 0.5 * r2) * weight);
        let (share_a, share_b) = (share * a[W + l], share * b[W + l]);
        a[DX + l] += share_a * x;
        a[DY + l] += share_a * y;
        a[DZ + l] += share_a * z;
        b[DX + l] -= share_b * x;
        b[DY + l] -= share_b * y;
        b[DZ + l] -= share_b * z;
    }
}

/// The paper's equation (2), `x' = x + (x − x_prev)(1 − D) + a Δt²`, but for adding the displacement to the
/// position: [`commit`]. Pinned particles keep the displacement that they were given.
#[inline(always)]
pub(super) fn integrate(row: &mut [Block], kept: f32, acceleration_dt2: [f32; 3]) {
    for block in row {
        let view = block.view_mut();
        for (at, acceleration) in [DX, DY, DZ].into_iter().zip(acceleration_dt2) {
            for l in 0..LANES {
                let moved = view[at + l] * kept + acceleration;
                view[at + l] = if view[W + l] > 0.0 {
                    moved
                } else {
                    view[at + l]
                };
            }
        }
    }
}

/// Ends a sub-step: displacements become positions.
#[inline(always)]
pub(super) fn commit(row: &mut [Block]) {
    for block in row {
        let view = block.view_mut();
        for at in X..W {
            view[at] += view[DX + at];
        }
    }
}

/// Pulls each particle back that is farther from `anchor` than its tether is long: a unilateral constraint
/// against a particle that nothing moves.
#[inline(always)]
pub(super) fn tether(view: &mut View, anchor: [&Lanes; 3], length_square: &Lanes) {
    for l in 0..LANES {
        let x = (view[X + l] - anchor[0][l]) + view[DX + l];
        let y = (view[Y + l] - anchor[1][l]) + view[DY + l];
        let z = (view[Z + l] - anchor[2][l]) + view[DZ + l];
        let q = x * x + y * y + z * z;
        let r2 = length_square[l];
        let beyond = q - r2;
        let beyond = if beyond > 0.0 { beyond } else { 0.0 };
        let share = beyond / (1.5 * q + 0.5 * r2);
        view[DX + l] -= share * x;
        view[DY + l] -= share * y;
        view[DZ + l] -= share * z;
    }
}

/// Raises `largest` to the squared lengths of eight springs, those of infinite softness left out.
#[inline(always)]
pub(super) fn measure(a: &View, b: &View, softness: &Lanes, largest: &mut Lanes) {
    for l in 0..LANES {
        let (x, y, z) = (
            b[X + l] - a[X + l],
            b[Y + l] - a[Y + l],
            b[Z + l] - a[Z + l],
        );
        let q = x * x + y * y + z * z;
        let q = if softness[l] < f32::INFINITY { q } else { 0.0 };
        largest[l] = if q > largest[l] { q } else { largest[l] };
    }
}
