//! The price of exactness: three ways to keep a particle's displacement through a sweep, in blocks of eight lanes
//! as the solver's. A displacement must not see the rounding of the position; the cheapest form lets it.

use multiversion::multiversion;

use crate::{median, seconds};

const LANES: usize = 8;
/// Where position, inverse mass and displacement begin in a block.
const X: usize = 0;
const W: usize = 3 * LANES;
const D: usize = 4 * LANES;

type Block = [f32; 8 * LANES];

/// Positions change alone; the displacement is their change over the sub-step.
const POSITIONS_ALONE: u8 = 0;
/// Position and displacement change alike.
const BOTH: u8 = 1;
/// The displacement changes alone; a particle is at position + displacement.
const DISPLACEMENTS_ALONE: u8 = 2;

#[inline(always)]
fn relax<const FORM: u8>(a: &mut Block, b: &mut Block, rest_square: f32) {
    for l in 0..LANES {
        let span = |axis: usize| {
            let at = axis * LANES + l;
            let still = b[X + at] - a[X + at];
            if FORM == DISPLACEMENTS_ALONE {
                still + (b[D + at] - a[D + at])
            } else {
                still
            }
        };
        let (x, y, z) = (span(0), span(1), span(2));
        let q = x * x + y * y + z * z;
        let weight = a[W + l] + b[W + l];
        let share = (q - rest_square) / ((1.5 * q + 0.5 * rest_square) * weight);
        let (share_a, share_b) = (share * a[W + l], share * b[W + l]);
        for (axis, moved) in [x, y, z].into_iter().enumerate() {
            let at = axis * LANES + l;
            if FORM != DISPLACEMENTS_ALONE {
                a[X + at] += share_a * moved;
                b[X + at] -= share_b * moved;
            }
            if FORM != POSITIONS_ALONE {
                a[D + at] += share_a * moved;
                b[D + at] -= share_b * moved;
            }
        }
    }
}

#[inline(always)]
fn sweep<const FORM: u8>(upper: &mut [Block], lower: &mut [Block], rest_square: f32) {
    for (a, b) in upper.iter_mut().zip(lower) {
        relax::<FORM>(a, b, rest_square);
    }
}

#[multiversion(targets("x86_64+avx+avx2"))]
fn positions_alone(upper: &mut [Block], lower: &mut [Block], rest_square: f32) {
    sweep::<POSITIONS_ALONE>(upper, lower, rest_square);
}

#[multiversion(targets("x86_64+avx+avx2"))]
fn both(upper: &mut [Block], lower: &mut [Block], rest_square: f32) {
    sweep::<BOTH>(upper, lower, rest_square);
}

#[multiversion(targets("x86_64+avx+avx2"))]
fn displacements_alone(upper: &mut [Block], lower: &mut [Block], rest_square: f32) {
    sweep::<DISPLACEMENTS_ALONE>(upper, lower, rest_square);
}

/// Prints what a spring costs in each form, in the first cache.
pub fn compare(turns: usize) {
    const BLOCKS: usize = 32;
    const SWEEPS: usize = 20_000;
    let block = |row: usize| -> Block {
        std::array::from_fn(|at| match at / LANES {
            0 => (at % LANES) as f32 * 0.03,
            1 => ((at * 7919 + row) % 101) as f32 * 1.0e-4,
            2 => row as f32 * 0.031,
            3 => 1.0,
            _ => 0.0,
        })
    };
    let forms: [(&str, fn(&mut [Block], &mut [Block], f32)); 3] = [
        ("positions alone (cheap)", positions_alone),
        ("both (exact)", both),
        (
            "displacements alone (exact, the solver's)",
            displacements_alone,
        ),
    ];
    let mut found = [const { Vec::new() }; 3];
    for _ in 0..turns {
        for ((_, form), found) in forms.iter().zip(&mut found) {
            let (mut upper, mut lower) = (vec![block(0); BLOCKS], vec![block(1); BLOCKS]);
            found.push(seconds(|| {
                for _ in 0..SWEEPS {
                    form(&mut upper, &mut lower, 9.0e-4);
                }
            }));
        }
    }
    println!(
        "\nthe displacement through a sweep, {BLOCKS} blocks of {LANES} springs in the first cache: ns a spring\n"
    );
    for ((name, _), found) in forms.iter().zip(&mut found) {
        let ns = 1.0e9 * median(found) / (SWEEPS * BLOCKS * LANES) as f64;
        println!("{name:>42} {ns:>7.3}");
    }
}
