//! The arithmetic of twisted cells, as [`pentadiagonal`](super::pentadiagonal) does that of bent chains.
//!
//! The cells between two columns are a strip. The twist of a cell is the change of the difference u between both
//! columns, from its upper row to its lower one. The resistance to twist changes only u, by a tridiagonal system:
//! `m e + s k (2 e − e₋ − e₊) = s k (u₋ − 2 u + u₊)` for the change e of u, where m is the mass 1 ⁄ (w + w') that
//! resists it. Strips that begin in an even column share no particle, nor do the odd ones: eight of them are solved
//! side by side.

use super::pentadiagonal::{Factor, MIN_MOMENT, MIN_MOVE, MOVES, Vec3Lanes, flush, link};
use crate::cloth::{Block, LANES, Lanes, View, W};

/// Each pair's difference, from left to right, of a row's even or odd pairs.
#[inline(always)]
pub(crate) fn twist_links(row: &[Block], is_odd: bool, links: &mut [Vec3Lanes]) {
    let pairs = row[usize::from(is_odd)..].chunks_exact(2);
    for (pair, out) in pairs.zip(&mut *links) {
        if let [a, b] = pair {
            link(a.view(), b.view(), out);
        }
    }
    if is_odd && let ([first, .., last], Some(out)) = (row, links.last_mut()) {
        link(last.view(), first.shifted(), out);
    }
}

/// The moment of a cell (kg m), and the remainder of a row's force.
#[inline(always)]
fn forward(
    [own, next]: [&Lanes; 2],
    stiffness: &Lanes,
    above: &Lanes,
    lower: &Lanes,
    before: &Lanes,
) -> [Lanes; 2] {
    let (mut moment, mut out) = ([0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        moment[l] = stiffness[l] * (next[l] - own[l]);
        out[l] = flush((moment[l] - above[l]) - lower[l] * before[l], MIN_MOMENT);
    }
    [moment, out]
}

/// Solves a row forwards. `links` are its own and the next row's, `moments` those of the cells above it, which become those of
/// the cells below; `before` is the row before, solved.
#[inline(always)]
pub(crate) fn twist_forward(
    [own, next]: [&[Vec3Lanes]; 2],
    stiffness: &[Lanes],
    moments: &mut [Vec3Lanes],
    before: &[Vec3Lanes],
    factors: &[Factor],
    out: &mut [Vec3Lanes],
) {
    let pairs = out.len();
    let (own, next, stiffness) = (&own[..pairs], &next[..pairs], &stiffness[..pairs]);
    let (moments, before, factors) = (&mut moments[..pairs], &before[..pairs], &factors[..pairs]);
    for j in 0..pairs {
        let lower = &factors[j][0];
        for axis in 0..3 {
            let links = [&own[j][axis], &next[j][axis]];
            [moments[j][axis], out[j][axis]] = forward(
                links,
                &stiffness[j],
                &moments[j][axis],
                lower,
                &before[j][axis],
            );
        }
    }
}

/// Change of a row's differences, given that of the next row's.
#[inline(always)]
fn backward(solved: &Lanes, inverse: &Lanes, lower: &Lanes, next: &Lanes) -> Lanes {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = flush(solved[l] * inverse[l] - lower[l] * next[l], MIN_MOVE);
    }
    out
}

/// Moves both of a pair by their parts of the change, in inverse proportion to their masses.
#[inline(always)]
fn part(a: &mut View, b: &mut View, mass: &Lanes, changes: &Vec3Lanes) {
    for axis in 0..3 {
        let (at, changes) = (MOVES[axis], &changes[axis]);
        for l in 0..LANES {
            let pulled = changes[l] * mass[l];
            a[at + l] -= pulled * a[W + l];
            b[at + l] += pulled * b[W + l];
        }
    }
}

/// Solves a row backwards and moves its particles: `factors` are its own and the next row's, `next` the next row, solved.
#[inline(always)]
pub(crate) fn twist_backward(
    row: &mut [Block],
    is_odd: bool,
    [own, below]: [&[Factor]; 2],
    next: &[Vec3Lanes],
    out: &mut [Vec3Lanes],
) {
    let pairs = out.len();
    let (own, below, next) = (&own[..pairs], &below[..pairs], &next[..pairs]);
    for j in 0..pairs {
        let (inverse, lower) = (&own[j][1], &below[j][0]);
        for axis in 0..3 {
            out[j][axis] = backward(&out[j][axis], inverse, lower, &next[j][axis]);
        }
    }
    let moved = row[usize::from(is_odd)..].chunks_exact_mut(2);
    for ((pair, factor), changes) in moved.zip(own).zip(&*out) {
        if let [a, b] = pair {
            part(a.view_mut(), b.view_mut(), &factor[2], changes);
        }
    }
    if is_odd
        && let ([first, .., last], Some(factor), Some(changes)) = (row, own.last(), out.last())
    {
        part(last.view_mut(), first.shifted_mut(), &factor[2], changes);
    }
}
