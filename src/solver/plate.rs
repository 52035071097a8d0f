//! The arithmetic of a bent grid's forces, all four directions at once, as [`thread`](super::thread) solves them one by one.
//!
//! In each direction a particle has the moment `k (x_{i−1} − 2 x_i + x_{i+1})`, and is pushed by twice its own less those of the
//! particles beside it. Three stages follow each other down the rows: where the particles are, their moments, their forces.
//! Eight particles ask for some 90 additions and multiplications; what the stages hand on stays in the caches next to the core.

use super::thread::{MIN_MOVE, MOVES, PLACES, Trio, flush, to_left, to_right};
use crate::cloth::{Block, LANES, Lanes, W};

/// Blocks on either side of a row that repeat its other end, so that each block has its neighbours beside it.
pub(super) const EDGE: usize = 1;

/// Of eight particles on an axis the moments (N m ⁄ m²) down the columns, along the rows, down to the right and up to the
/// right; and twice their sum.
pub(super) type Moments = [[Lanes; 3]; KINDS];
/// Numbers of [`Moments`] on an axis.
const KINDS: usize = 5;
const DOWN: usize = 0;
const ACROSS: usize = 1;
const FALLING: usize = 2;
const RISING: usize = 3;
const SUM: usize = 4;

/// k (N/m) of eight particles along the rows, down the columns and along each diagonal.
pub(super) type Stiffness = [Lanes; 3];

/// Where a row's particles will be after this part of their displacements, seen from `origin`: next to the cloth, so that no digit
/// of a displacement is lost to its distance from the world's origin.
#[inline(always)]
pub(super) fn plate_places(row: &[Block], origin: &[f32; 3], part: f32, places: &mut [Trio]) {
    for (block, out) in row.iter().zip(&mut places[EDGE..]) {
        let view = block.view();
        for axis in 0..3 {
            let mut place = [0.0; LANES];
            for l in 0..LANES {
                let moved = part * view[MOVES[axis] + l];
                place[l] = (view[PLACES[axis] + l] - origin[axis]) + moved;
            }
            out[axis] = place;
        }
    }
    let end = row.len() + EDGE;
    places[0] = to_right(&places[end - EDGE]);
    places[end] = to_left(&places[EDGE]);
}

#[inline(always)]
fn moment(stiffness: &Lanes, twice: &Lanes, a: &Lanes, b: &Lanes) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = stiffness[l] * ((a[l] + b[l]) - twice[l]);
    }
    out
}

#[inline(always)]
fn sum(a: &Lanes, b: &Lanes) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = a[l] + b[l];
    }
    out
}

/// Moments of a row, from the places of the row above, of itself and of the row below.
#[inline(always)]
pub(super) fn plate_moments(
    [above, own, below]: [&[Trio]; 3],
    stiffness: &[Stiffness],
    moments: &mut [Moments],
) {
    let strip = stiffness.len();
    let (above, own) = (&above[..strip + 2 * EDGE], &own[..strip + 2 * EDGE]);
    let below = &below[..strip + 2 * EDGE];
    let inner = &mut moments[EDGE..][..strip];
    for j in 0..strip {
        let [across, down, oblique] = &stiffness[j];
        let (left, at, right) = (j, j + 1, j + 2);
        for axis in 0..3 {
            let twice = sum(&own[at][axis], &own[at][axis]);
            let of_down = moment(down, &twice, &above[at][axis], &below[at][axis]);
            let of_across = moment(across, &twice, &own[left][axis], &own[right][axis]);
            let falling = moment(oblique, &twice, &above[left][axis], &below[right][axis]);
            let rising = moment(oblique, &twice, &below[left][axis], &above[right][axis]);
            let all = sum(&sum(&of_down, &of_across), &sum(&falling, &rising));
            inner[j][DOWN][axis] = of_down;
            inner[j][ACROSS][axis] = of_across;
            inner[j][FALLING][axis] = falling;
            inner[j][RISING][axis] = rising;
            inner[j][SUM][axis] = sum(&all, &all);
        }
    }
    // Those down the columns, and the sum, concern nobody beside.
    let end = strip + EDGE;
    for kind in [ACROSS, FALLING, RISING] {
        moments[0][kind] = to_right(&moments[end - EDGE][kind]);
        moments[end][kind] = to_left(&moments[EDGE][kind]);
    }
}

/// How far a force moves particles: that of twice their own moments less those beside them.
#[inline(always)]
fn pushed(weight: &Lanes, twice: &Lanes, beside: [&Lanes; 8]) -> Lanes {
    let [a, b, c, d, e, f, g, h] = beside;
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        let direct = (a[l] + b[l]) + (c[l] + d[l]);
        let oblique = (e[l] + f[l]) + (g[l] + h[l]);
        out[l] = flush(weight[l] * (twice[l] - (direct + oblique)), MIN_MOVE);
    }
    out
}

/// Moves a row's particles by their forces times `weight` (s²) over their masses: `moments` are those of the row above, of this
/// and of the row below.
#[inline(always)]
pub(super) fn plate_push(moments: [&[Moments]; 3], weight: f32, row: &mut [Block]) {
    let strip = row.len();
    let [above, own, below] = moments.map(|of| &of[..strip + 2 * EDGE]);
    for (j, block) in row.iter_mut().enumerate() {
        let (left, at, right) = (j, j + 1, j + 2);
        let view = block.view_mut();
        let mut weights = [0.0; LANES];
        for l in 0..LANES {
            weights[l] = weight * view[W + l];
        }
        for axis in 0..3 {
            let beside = [
                &above[at][DOWN][axis],
                &below[at][DOWN][axis],
                &own[left][ACROSS][axis],
                &own[right][ACROSS][axis],
                &above[left][FALLING][axis],
                &below[right][FALLING][axis],
                &below[left][RISING][axis],
                &above[right][RISING][axis],
            ];
            let moved = pushed(&weights, &own[at][SUM][axis], beside);
            for l in 0..LANES {
                view[MOVES[axis] + l] += moved[l];
            }
        }
    }
}
