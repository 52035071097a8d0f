//! Threads within rows: sixteen rows at a time, their lanes turned so that each row is a lane.

use bevy::math::{Mat4, Vec4};

use super::link::{Family, equation, from_left};
use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W};

/// Rows that are solved at once.
pub(crate) const GROUP: usize = 16;

/// Places in the terms of a spring.
const DIAGONAL: usize = 0;
const OFF: usize = 1;
const RIGHT: usize = 2;

/// One number of each row.
pub(crate) type Rows = [f32; GROUP];

/// Transposes four by four numbers.
#[inline(always)]
fn turned([a, b, c, d]: [&[f32]; 4]) -> [[f32; 4]; 4] {
    let [a, b, c, d] = [a, b, c, d].map(Vec4::from_slice);
    Mat4::from_cols(a, b, c, d).transpose().to_cols_array_2d()
}

/// The rows of the system for the springs of one row of the cloth.
#[inline(always)]
pub(crate) fn row_equations(
    row: &[Block],
    family: &Family,
    ways: &mut [[Lanes; 3]],
    terms: &mut [[Lanes; 3]],
) {
    let strip = row.len();
    for (j, (way, terms)) in ways.iter_mut().zip(terms.iter_mut()).enumerate() {
        let b = match row.get(j + 1) {
            Some(b) => b.view(),
            None => row[0].shifted(),
        };
        let spring = equation(row[j].view(), b, family, j);
        *way = spring.way;
        (terms[DIAGONAL], terms[RIGHT]) = (spring.diagonal, spring.right);
    }
    for j in 1..strip {
        coupling(row[j].view(), &ways[j - 1], &ways[j], &mut terms[j][OFF]);
    }
    // The first spring of a strip follows on the last of the strip before.
    let before = ways[strip - 1].map(|axis| from_left(&axis));
    coupling(row[0].view(), &before, &ways[0], &mut terms[0][OFF]);
}

/// What a spring has to do with the one before it, whose second particle is its first.
#[inline(always)]
fn coupling(a: &View, before: &[Lanes; 3], way: &[Lanes; 3], off: &mut Lanes) {
    for l in 0..LANES {
        let along = before[0][l] * way[0][l] + before[1][l] * way[1][l] + before[2][l] * way[2][l];
        off[l] = -a[W + l] * along;
    }
}

/// Moves the particles of a row by what its springs pull with.
#[inline(always)]
pub(crate) fn pull_row(row: &mut [Block], ways: &mut [[Lanes; 3]], multipliers: &[[Lanes; 3]]) {
    for (way, [multiplier, ..]) in ways.iter_mut().zip(multipliers) {
        for axis in way {
            for l in 0..LANES {
                axis[l] *= multiplier[l];
            }
        }
    }
    let last = row.len() - 1;
    let before = ways[last].map(|axis| from_left(&axis));
    move_by(row[0].view_mut(), &before, &ways[0]);
    for (block, pulls) in row[1..].iter_mut().zip(ways.windows(2)) {
        move_by(block.view_mut(), &pulls[0], &pulls[1]);
    }
}

/// Moves eight particles by what the springs before and behind them pull with.
#[inline(always)]
fn move_by(view: &mut View, before: &[Lanes; 3], behind: &[Lanes; 3]) {
    for l in 0..LANES {
        let weight = view[W + l];
        view[DX + l] += weight * (before[0][l] - behind[0][l]);
        view[DY + l] += weight * (before[1][l] - behind[1][l]);
        view[DZ + l] += weight * (before[2][l] - behind[2][l]);
    }
}

/// Turns what the blocks of [`GROUP`] rows know of their springs to what each column's springs know of their rows.
#[inline(always)]
pub(crate) fn turn_terms(terms: &[[Lanes; 3]], unknowns: &mut [[Rows; 3]], strip: usize) {
    for j in 0..strip {
        for row in (0..GROUP).step_by(4) {
            let of = |at: usize| &terms[(row + at) * strip + j];
            let rows = [of(0), of(1), of(2), of(3)];
            for lane in (0..LANES).step_by(4) {
                for at in 0..3 {
                    let numbers = turned(rows.map(|row| &row[at][lane..lane + 4]));
                    for (l, numbers) in numbers.iter().enumerate() {
                        let into = &mut unknowns[(lane + l) * strip + j][at];
                        into[row..row + 4].copy_from_slice(numbers);
                    }
                }
            }
        }
    }
}

/// And back: the multipliers, in the place of the diagonal.
#[inline(always)]
pub(crate) fn turn_back(unknowns: &[[Rows; 3]], terms: &mut [[Lanes; 3]], strip: usize) {
    for j in 0..strip {
        for lane in (0..LANES).step_by(4) {
            let of = |at: usize| &unknowns[(lane + at) * strip + j][RIGHT];
            let lanes = [of(0), of(1), of(2), of(3)];
            for row in (0..GROUP).step_by(4) {
                let numbers = turned(lanes.map(|column| &column[row..row + 4]));
                for (r, numbers) in numbers.iter().enumerate() {
                    let into = &mut terms[(row + r) * strip + j][0];
                    into[lane..lane + 4].copy_from_slice(numbers);
                }
            }
        }
    }
}

/// Solves tridiagonal systems from both ends at once, so that two eliminations run side by side. Of `springs` unknowns.
#[inline(always)]
pub(crate) fn solve_turned(unknowns: &mut [[Rows; 3]], springs: usize) {
    let none = [0.0; GROUP];
    let (mut first, mut last) = ([none; 2], [none; 2]);
    let middle = springs / 2;
    let (low, high) = unknowns.split_at_mut(middle);
    let (own, high) = high.split_first_mut().expect("a spring");
    let (high, beyond) = high.split_at_mut(springs - 1 - middle);
    let mut behind = none;
    for (k, row) in low.iter_mut().enumerate() {
        let off = row[OFF];
        step(row, &off, &mut first);
        // One fewer behind the middle, or as many.
        let Some(at) = high.len().checked_sub(k + 1) else {
            continue;
        };
        let off = if at + 1 < high.len() {
            high[at + 1][OFF]
        } else {
            none
        };
        step(&mut high[at], &off, &mut last);
        behind = high[0][OFF];
    }
    let mut value = none;
    for r in 0..GROUP {
        let off = own[OFF][r];
        let beside = off * (off * first[0][r]) + behind[r] * (behind[r] * last[0][r]);
        let known = off * first[1][r] + behind[r] * last[1][r];
        value[r] = (own[RIGHT][r] - known) / (own[DIAGONAL][r] - beside);
    }
    own[RIGHT] = value;
    let (mut before, mut after, mut off) = (value, value, own[OFF]);
    for (k, row) in low.iter_mut().rev().enumerate() {
        back(row, &off, &mut before);
        off = row[OFF];
        if let Some(row) = high.get_mut(k) {
            let off = row[OFF];
            back(row, &off, &mut after);
        }
    }
    for row in beyond {
        row[RIGHT] = none;
    }
}

/// Eliminates the spring before, of which pivot and right side are known.
#[inline(always)]
fn step(row: &mut [Rows; 3], off: &Rows, known: &mut [Rows; 2]) {
    for r in 0..GROUP {
        let own = 1.0 / (row[DIAGONAL][r] - off[r] * (off[r] * known[0][r]));
        let value = (row[RIGHT][r] - off[r] * known[1][r]) * own;
        (known[0][r], known[1][r]) = (own, value);
    }
    (row[DIAGONAL], row[RIGHT]) = (known[0], known[1]);
}

/// Puts in the spring beside, of which the multiplier is known.
#[inline(always)]
fn back(row: &mut [Rows; 3], off: &Rows, known: &mut Rows) {
    for r in 0..GROUP {
        known[r] = row[RIGHT][r] - row[DIAGONAL][r] * (off[r] * known[r]);
    }
    row[RIGHT] = *known;
}
