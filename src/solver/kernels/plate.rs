//! The arithmetic of a bent grid's forces, all at once, as [`pentadiagonal`](super::pentadiagonal) and [`twist`](super::twist) solve
//! them one by one.
//!
//! Along its row and its column a particle has the moment `k (x_{i−1} − 2 x_i + x_{i+1})`. It is pushed by twice its
//! own moment, less those of the particles beside it. A cell has the moment `k (x₀₀ − x₀₁ − x₁₀ + x₁₁)`, and pushes its
//! corners by it, with these signs reversed. Three stages follow each other down the rows: positions, moments, forces.
//! Data between the stages stays in the caches next to the core.

use super::{
    each::three,
    pentadiagonal::{MIN_MOVE, MOVES, PLACES, Vec3Lanes, flush},
};
use crate::cloth::{Block, LANES, Lanes, W};

/// Blocks on either side of a row that repeat its other end, so that each block has its neighbours beside it.
pub(crate) const EDGE: usize = 1;

/// Of eight particles on an axis the moments (N m ⁄ m²) down the columns, along the rows, and of the cells below and to the right
/// of them.
pub(crate) type Moments = [[Lanes; 3]; KINDS];
/// Numbers of [`Moments`] on an axis.
const KINDS: usize = 3;
const DOWN: usize = 0;
const ACROSS: usize = 1;
const TWIST: usize = 2;

/// k (N/m) of eight particles along the rows, down the columns and of their cells.
pub(crate) type Stiffness = [Lanes; 3];

/// Each lane's left neighbour, in the lane before.
#[inline(always)]
fn to_right<const N: usize>(from: &[Lanes; N]) -> [Lanes; N] {
    let mut to = [[0.0; LANES]; N];
    for (to, from) in to.iter_mut().zip(from) {
        to[1..].copy_from_slice(&from[..LANES - 1]);
    }
    to
}

/// Each lane's right neighbour, in the lane after.
#[inline(always)]
fn to_left<const N: usize>(from: &[Lanes; N]) -> [Lanes; N] {
    let mut to = [[0.0; LANES]; N];
    for (to, from) in to.iter_mut().zip(from) {
        to[..LANES - 1].copy_from_slice(&from[1..]);
    }
    to
}

/// Where a row's particles will be after this part of their displacements, seen from `origin`: next to the cloth, so that no digit
/// of a displacement is lost to its distance from the world's origin.
#[inline(always)]
pub(crate) fn plate_places(row: &[Block], origin: &[f32; 3], part: f32, places: &mut [Vec3Lanes]) {
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
fn bend(stiffness: &Lanes, own: &Lanes, a: &Lanes, b: &Lanes) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = stiffness[l] * ((a[l] + b[l]) - (own[l] + own[l]));
    }
    out
}

#[inline(always)]
fn twist(stiffness: &Lanes, [a, b]: [&Lanes; 2], [c, d]: [&Lanes; 2]) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = stiffness[l] * ((a[l] - b[l]) - (c[l] - d[l]));
    }
    out
}

/// Moments of a row, from the places of the row above, of itself and of the row below.
#[inline(always)]
pub(crate) fn plate_moments(
    [above, own, below]: [&[Vec3Lanes]; 3],
    stiffness: &[Stiffness],
    moments: &mut [Moments],
) {
    let strip = stiffness.len();
    let (above, own) = (&above[..strip + 2 * EDGE], &own[..strip + 2 * EDGE]);
    let below = &below[..strip + 2 * EDGE];
    let inner = &mut moments[EDGE..][..strip];
    for j in 0..strip {
        let [across, down, cell] = &stiffness[j];
        let (left, at, right) = (j, j + 1, j + 2);
        for axis in 0..3 {
            let middle = &own[at][axis];
            let of_down = bend(down, middle, &above[at][axis], &below[at][axis]);
            let of_across = bend(across, middle, &own[left][axis], &own[right][axis]);
            let upper = [middle, &own[right][axis]];
            let of_cell = twist(cell, upper, [&below[at][axis], &below[right][axis]]);
            inner[j][DOWN][axis] = of_down;
            inner[j][ACROSS][axis] = of_across;
            inner[j][TWIST][axis] = of_cell;
        }
    }
    // Those down the columns concern nobody beside.
    let end = strip + EDGE;
    for kind in [ACROSS, TWIST] {
        moments[0][kind] = to_right(&moments[end - EDGE][kind]);
        moments[end][kind] = to_left(&moments[EDGE][kind]);
    }
}

/// The displacement of particles by the forces of twice their own moments, less those beside them, and of the four
/// cells around them.
#[inline(always)]
fn pushed(
    weight: &Lanes,
    own: [&Lanes; 2],
    beside: [&Lanes; 4],
    [above_left, above, left, cell]: [&Lanes; 4],
) -> Lanes {
    let [a, b, c, d] = beside;
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        let own = own[0][l] + own[1][l];
        let bent = (own + own) - ((a[l] + b[l]) + (c[l] + d[l]));
        let twisted = (above[l] - above_left[l]) + (left[l] - cell[l]);
        out[l] = flush(weight[l] * (bent + twisted), MIN_MOVE);
    }
    out
}

/// Moves a row's particles by their forces times `weight` (s²) over their masses: `moments` are those of the row above, of this
/// and of the row below.
#[inline(always)]
pub(crate) fn plate_push(moments: [&[Moments]; 3], weight: f32, row: &mut [Block]) {
    let strip = row.len();
    let [above, own, below] = three(|at| &moments[at][..strip + 2 * EDGE]);
    for (j, block) in row.iter_mut().enumerate() {
        let (left, at, right) = (j, j + 1, j + 2);
        let view = block.view_mut();
        let mut weights = [0.0; LANES];
        for l in 0..LANES {
            weights[l] = weight * view[W + l];
        }
        for axis in 0..3 {
            let bent = [&own[at][DOWN][axis], &own[at][ACROSS][axis]];
            let beside = [
                &above[at][DOWN][axis],
                &below[at][DOWN][axis],
                &own[left][ACROSS][axis],
                &own[right][ACROSS][axis],
            ];
            let cells = [
                &above[left][TWIST][axis],
                &above[at][TWIST][axis],
                &own[left][TWIST][axis],
                &own[at][TWIST][axis],
            ];
            let moved = pushed(&weights, bent, beside, cells);
            for l in 0..LANES {
                view[MOVES[axis] + l] += moved[l];
            }
        }
    }
}
