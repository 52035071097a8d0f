//! The arithmetic of bent chains, eight of them side by side, as [`chains`](super::chains) is that of springs.
//!
//! A chain's moments follow from the differences between neighbours, first of positions, then of displacements, so that no
//! digit of a displacement is lost to the position. They are the right side of a pentadiagonal system `(M + s K) e = −s K p`,
//! which is solved for what is added to the displacements, e: forwards with L, backwards with D and Lᵀ.

use super::each::three;
use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, View, X, Y, Z};

/// x, y and z of eight particles.
pub(crate) type Vec3Lanes = [Lanes; 3];

/// A particle's row of L, and of the inverse of D: to the particle before it, to the one before that, 1/D.
pub(crate) type Factor = [Lanes; 3];

/// Where each quantity of a [`Vec3Lanes`] is in a block.
pub(crate) const PLACES: [usize; 3] = [X, Y, Z];
pub(crate) const MOVES: [usize; 3] = [DX, DY, DZ];

/// Smaller values count as zero (kg m, and m): far from any motion they would be subnormal numbers, which are slow.
pub(crate) const MIN_MOMENT: f32 = 1.0e-25;
pub(crate) const MIN_MOVE: f32 = 1.0e-18;

#[inline(always)]
pub(crate) fn flush(number: f32, least: f32) -> f32 {
    // NaN stays to be seen.
    if number.abs() < least { 0.0 } else { number }
}

/// From each particle of `a` to that of `b` in the same lane.
#[inline(always)]
pub(crate) fn link(a: &View, b: &View, out: &mut Vec3Lanes) {
    for axis in 0..3 {
        let (place, moved) = (PLACES[axis], MOVES[axis]);
        for l in 0..LANES {
            out[axis][l] = (b[place + l] - a[place + l]) + (b[moved + l] - a[moved + l]);
        }
    }
}

/// From each particle of a row to the one below it.
#[inline(always)]
pub(crate) fn chain_links(from: &[Block], to: &[Block], links: &mut [Vec3Lanes]) {
    for ((a, b), out) in from.iter().zip(to).zip(links) {
        link(a.view(), b.view(), out);
    }
}

// Each of these makes eight numbers before any is stored: what is stored might else be what is loaded next, for all that the
// compiler knows.

#[inline(always)]
fn scaled_difference(scale: &Lanes, a: &Lanes, b: &Lanes) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = scale[l] * (a[l] - b[l]);
    }
    out
}

/// A particle's force, less what the two before it carry over.
#[inline(always)]
fn forward(
    [own, before, next]: [&Lanes; 3],
    lower: &Lanes,
    first: &Lanes,
    lowest: &Lanes,
    second: &Lanes,
) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        let force = (own[l] - before[l]) + (own[l] - next[l]);
        let rest = force - lower[l] * first[l];
        out[l] = flush(rest - lowest[l] * second[l], MIN_MOMENT);
    }
    out
}

/// Displacement of a particle, given those of the two after it.
#[inline(always)]
fn backward(
    solved: &Lanes,
    inverse: &Lanes,
    upper: &Lanes,
    first: &Lanes,
    uppermost: &Lanes,
    second: &Lanes,
) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        let rest = solved[l] * inverse[l] - upper[l] * first[l];
        out[l] = flush(rest - uppermost[l] * second[l], MIN_MOVE);
    }
    out
}

/// Moments of a row (kg m), from the links that lead to it and away from it.
#[inline(always)]
pub(crate) fn chain_moments(
    [before, after]: [&[Vec3Lanes]; 2],
    stiffness: &[Lanes],
    moments: &mut [Vec3Lanes],
) {
    for (((before, after), stiffness), out) in before.iter().zip(after).zip(stiffness).zip(moments)
    {
        for axis in 0..3 {
            out[axis] = scaled_difference(stiffness, &after[axis], &before[axis]);
        }
    }
}

/// Solves a row forwards: `moments` are those of the row before, of this and of the next one, `solved` the row before and the
/// one before that.
#[inline(always)]
pub(crate) fn chain_forward(
    moments: [&[Vec3Lanes]; 3],
    solved: [&[Vec3Lanes]; 2],
    factors: &[Factor],
    out: &mut [Vec3Lanes],
) {
    let strip = out.len();
    let [before, own, next] = three(|at| &moments[at][..strip]);
    let (first, second) = (&solved[0][..strip], &solved[1][..strip]);
    let factors = &factors[..strip];
    for j in 0..strip {
        let [lower, lowest, _] = &factors[j];
        for axis in 0..3 {
            let of = [&own[j][axis], &before[j][axis], &next[j][axis]];
            out[j][axis] = forward(of, lower, &first[j][axis], lowest, &second[j][axis]);
        }
    }
}

/// Solves a row backwards and moves its particles: `solved` and `factors` are those of the next row and of the one after that.
#[inline(always)]
pub(crate) fn chain_backward(
    blocks: &mut [Block],
    own: &[Factor],
    solved: [&[Vec3Lanes]; 2],
    factors: [&[Factor]; 2],
    out: &mut [Vec3Lanes],
) {
    let strip = blocks.len();
    let (own, out) = (&own[..strip], &mut out[..strip]);
    let (first, second) = (&solved[0][..strip], &solved[1][..strip]);
    let (upper, uppermost) = (&factors[0][..strip], &factors[1][..strip]);
    for (j, block) in blocks.iter_mut().enumerate() {
        let view = block.view_mut();
        let (inverse, upper, uppermost) = (&own[j][2], &upper[j][0], &uppermost[j][1]);
        for axis in 0..3 {
            let own = out[j][axis];
            let moved = backward(
                &own,
                inverse,
                upper,
                &first[j][axis],
                uppermost,
                &second[j][axis],
            );
            out[j][axis] = moved;
            for l in 0..LANES {
                view[MOVES[axis] + l] += moved[l];
            }
        }
    }
}

#[inline(always)]
fn transpose(from: &[Lanes; LANES]) -> [Lanes; LANES] {
    let mut to = [[0.0; LANES]; LANES];
    for (row, from) in from.iter().enumerate() {
        for (column, to) in to.iter_mut().enumerate() {
            to[row] = from[column];
        }
    }
    to
}

/// The links along up to eight rows, column by column: the lanes of a column are the rows.
#[inline(always)]
pub(crate) fn chain_columns(rows: &[Block], strip: usize, columns: &mut [Vec3Lanes]) {
    for j in 0..strip {
        let mut links = [[[0.0; LANES]; LANES]; 3];
        for (row, blocks) in rows.chunks_exact(strip).enumerate() {
            let next = if j + 1 < strip {
                blocks[j + 1].view()
            } else {
                blocks[0].shifted()
            };
            let mut of_row = [[0.0; LANES]; 3];
            link(blocks[j].view(), next, &mut of_row);
            for axis in 0..3 {
                links[axis][row] = of_row[axis];
            }
        }
        for (axis, links) in links.iter().enumerate() {
            for (lane, of_column) in transpose(links).into_iter().enumerate() {
                columns[lane * strip + j][axis] = of_column;
            }
        }
    }
}

/// Solves eight rows, each from its first column to its last and back, in place of their links.
#[inline(always)]
pub(crate) fn chain_rows(columns: &mut [Vec3Lanes], stiffness: &Lanes, factors: &[Factor]) {
    let none = [[0.0; LANES]; 3];
    let count = columns.len();
    let moment = |before: &Vec3Lanes, after: &Vec3Lanes| {
        let mut moment = none;
        for axis in 0..3 {
            moment[axis] = scaled_difference(stiffness, &after[axis], &before[axis]);
        }
        moment
    };
    let (mut before, mut own) = (none, none);
    let (mut first, mut second) = (none, none);
    for at in 0..count {
        let next = if at + 2 < count {
            moment(&columns[at], &columns[at + 1])
        } else {
            none
        };
        let [lower, lowest, _] = &factors[at];
        let solved = &mut columns[at];
        for axis in 0..3 {
            let of = [&own[axis], &before[axis], &next[axis]];
            solved[axis] = forward(of, lower, &first[axis], lowest, &second[axis]);
        }
        (before, own) = (own, next);
        (second, first) = (first, *solved);
    }
    (first, second) = (none, none);
    let (mut upper, mut uppermost) = ([0.0; LANES], [0.0; LANES]);
    let mut after = [0.0; LANES];
    for (solved, [lower, lowest, inverse]) in columns.iter_mut().zip(factors).rev() {
        for axis in 0..3 {
            let own = solved[axis];
            solved[axis] = backward(
                &own,
                inverse,
                &upper,
                &first[axis],
                &uppermost,
                &second[axis],
            );
        }
        (second, first) = (first, *solved);
        (upper, uppermost, after) = (*lower, after, *lowest);
    }
}

/// Moves the particles of up to eight rows by their solutions, column by column.
#[inline(always)]
pub(crate) fn chain_finish(columns: &[Vec3Lanes], strip: usize, rows: &mut [Block]) {
    for j in 0..strip {
        for axis in 0..3 {
            let mut of_columns = [[0.0; LANES]; LANES];
            for (lane, of_column) in of_columns.iter_mut().enumerate() {
                *of_column = columns[lane * strip + j][axis];
            }
            let of_rows = transpose(&of_columns);
            for (blocks, of_row) in rows.chunks_exact_mut(strip).zip(&of_rows) {
                let view = blocks[j].view_mut();
                for l in 0..LANES {
                    view[MOVES[axis] + l] += of_row[l];
                }
            }
        }
    }
}
