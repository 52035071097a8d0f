//! Chains that lead from row to row: columns, and both diagonals. The lanes are side by side, each in a chain of its own.
//!
//! A chain's system is solved by elimination: forward from its first spring to its last, and back. Where a diagonal
//! reaches the last block of a row, it continues in the first block, one lane on. Then all data of a spring is in the
//! lanes of its second particle, and on the way back its pull is moved to those of its first.
//!
//! # The floor
//! Eight springs need some 70 additions, multiplications and comparisons, and two divisions. They wait only where one
//! spring needs the pivot of the one before. That takes a division, a subtraction and two multiplications, some 25
//! cycles, while the other blocks of the row are worked on. So rows of few blocks are bound by that, others by the
//! arithmetic. Data for the next row lies in memory. To read it one lane aside, before it has left the store buffer,
//! would cost as much again. So it is moved in registers, by loops that carry a lane's number into the next.

use super::{
    beside::Chains,
    link::{Before, Behind, Link, SpringBand, after, damped, span, terms},
};
use crate::{
    cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W},
    solver::kernels::each::three,
};

/// Multipliers of springs that have not pulled.
const NONE: Lanes = [0.0; LANES];

/// Eliminates the springs before. With `CROSSES`, the result is moved by a lane to the right.
#[inline(always)]
fn eliminate<const CROSSES: bool, const DAMPED: bool, const AGAIN: bool>(
    [a, b]: [&View; 2],
    (springs, at): (&SpringBand, usize),
    pulled: &Lanes,
    before: &mut Before,
    link: &mut Link,
) {
    let (softness, hold) = (&springs.softness[at], &springs.hold[at]);
    let mut lane_before = [0.0; 6];
    for l in 0..LANES {
        let [x, y, z] = span(a, b, springs.inverse_rest, l);
        let weight = a[W + l] + b[W + l];
        let softness = if DAMPED {
            springs.kept * softness[l]
        } else {
            softness[l]
        };
        let [diagonal, right] = terms([x, y, z], weight, softness, hold[l], springs.rest);
        let right = if DAMPED {
            damped(right, [a, b], [x, y, z], springs, l)
        } else if AGAIN {
            after(right, [x, y, z], softness, pulled[l])
        } else {
            right
        };
        let along = before.span[0][l] * x + before.span[1][l] * y + before.span[2][l] * z;
        let off = -a[W + l] * along;
        let share = off * before.pivot[l];
        let pivot = 1.0 / (diagonal - off * share);
        let right = (right - off * before.right[l]) * pivot;
        let own = [x, y, z, share, pivot, right];
        let [x, y, z, share, pivot, right] = if CROSSES { lane_before } else { own };
        lane_before = own;
        [link.span[0][l], link.span[1][l], link.span[2][l]] = [x, y, z];
        [before.span[0][l], before.span[1][l], before.span[2][l]] = [x, y, z];
        [link.share[l], before.pivot[l]] = [share, pivot];
        [link.right[l], before.right[l]] = [right, right];
    }
}

/// Solves for the multipliers, given those behind them, and moves the particles in between. With `CROSSES`, the results
/// for the springs before are moved by a lane to the left.
#[inline(always)]
fn substitute<const CROSSES: bool>(b: &mut View, link: &mut Link, behind: &mut Behind) {
    let mut lane_behind = [0.0; 4];
    for l in 0..LANES {
        let l = if CROSSES { LANES - 1 - l } else { l };
        let multiplier = link.right[l] - behind.given[l];
        let [x, y, z] = three(|axis| link.span[axis][l] * multiplier);
        b[DX + l] += b[W + l] * (x - behind.pull[0][l]);
        b[DY + l] += b[W + l] * (y - behind.pull[1][l]);
        b[DZ + l] += b[W + l] * (z - behind.pull[2][l]);
        link.right[l] = multiplier;
        let own = [x, y, z, link.share[l] * multiplier];
        let [x, y, z, given] = if CROSSES { lane_behind } else { own };
        lane_behind = own;
        [behind.pull[0][l], behind.pull[1][l], behind.pull[2][l]] = [x, y, z];
        behind.given[l] = given;
    }
}

/// Moves particles at the head of their chains.
#[inline(always)]
fn pull_head(a: &mut View, pull: &[Lanes; 3]) {
    for l in 0..LANES {
        a[DX + l] -= a[W + l] * pull[0][l];
        a[DY + l] -= a[W + l] * pull[1][l];
        a[DZ + l] -= a[W + l] * pull[2][l];
    }
}

/// Solves chains that lead from row to row.
#[inline(always)]
pub(crate) fn solve_chains(chains: &mut Chains, springs: &SpringBand) {
    if chains.is_oblique() {
        solve::<true, false>(chains, springs);
    } else {
        solve::<false, false>(chains, springs);
    }
}

/// The same with damping along them.
#[inline(always)]
pub(crate) fn solve_damped_chains(chains: &mut Chains, springs: &SpringBand) {
    if chains.is_oblique() {
        solve::<true, true>(chains, springs);
    } else {
        solve::<false, true>(chains, springs);
    }
}

#[inline(always)]
fn solve<const OBLIQUE: bool, const DAMPED: bool>(chains: &mut Chains, springs: &SpringBand) {
    let Chains {
        rows,
        width,
        links,
        before,
        behind,
    } = chains;
    let last = rows.strip() - 1;
    before.fill(Before::NONE);
    let mut upper = rows.at(0);
    for (number, links) in links.chunks_exact_mut(*width).enumerate() {
        let lower = rows.at(number + 1);
        let first = springs.first_of(number);
        let mut block = upper.first;
        for (chain, (link, before)) in links.iter_mut().zip(&mut **before).enumerate() {
            let (a, b) = (upper.block(chain).view(), lower.block(chain));
            let own = (springs, first + block);
            if OBLIQUE && block == last {
                let b = b.shifted();
                eliminate::<true, DAMPED, false>([a, b], own, &NONE, before, link);
            } else {
                let b = b.view();
                eliminate::<false, DAMPED, false>([a, b], own, &NONE, before, link);
            }
            block = if block == last { 0 } else { block + 1 };
        }
        upper = lower;
    }
    behind.fill(Behind::NONE);
    for (number, links) in links.chunks_exact_mut(*width).enumerate().rev() {
        let mut lower = rows.at_mut(number + 1);
        let mut block = lower.first;
        for (chain, (link, behind)) in links.iter_mut().zip(&mut **behind).enumerate() {
            let b = lower.block(chain).view_mut();
            if OBLIQUE && block == 0 {
                substitute::<true>(b, link, behind);
            } else {
                substitute::<false>(b, link, behind);
            }
            block = if block == last { 0 } else { block + 1 };
        }
    }
    let mut heads = rows.at_mut(0);
    for (chain, behind) in behind.iter().enumerate() {
        pull_head(heads.block(chain).view_mut(), &behind.pull);
    }
}

/// Columns, of which some are solved again.
pub(crate) struct Columns<'a> {
    /// Of the whole grid.
    pub blocks: &'a mut [Block],
    /// Blocks in a row.
    pub strip: usize,
    /// The blocks of a row whose columns are solved.
    pub chosen: &'a [u32],
    pub links: &'a mut [Link],
    pub before: &'a mut [Before],
    pub behind: &'a mut [Behind],
    /// For elastic springs: the multipliers of those that lead to each row from the one above (m kg).
    pub pulled: &'a mut [Lanes],
}

/// Solves the chosen columns, of rigid springs.
#[inline(always)]
pub(crate) fn solve_columns(columns: &mut Columns, springs: &SpringBand) {
    solve_chosen::<false>(columns, springs);
}

/// The same of elastic springs, which go on from what they have pulled with.
#[inline(always)]
pub(crate) fn solve_columns_again(columns: &mut Columns, springs: &SpringBand) {
    solve_chosen::<true>(columns, springs);
}

#[inline(always)]
fn solve_chosen<const AGAIN: bool>(columns: &mut Columns, springs: &SpringBand) {
    let Columns {
        blocks,
        strip,
        chosen,
        links,
        before,
        behind,
        pulled,
    } = columns;
    let (strip, width) = (*strip, chosen.len());
    let (before, behind) = (&mut before[..width], &mut behind[..width]);
    let count = blocks.len() / strip - 1;
    before.fill(Before::NONE);
    for (row, links) in links.chunks_exact_mut(width).take(count).enumerate() {
        let (upper, lower) = blocks[row * strip..].split_at(strip);
        for (&block, (link, before)) in chosen.iter().zip(links.iter_mut().zip(&mut *before)) {
            let block = block as usize;
            let ends = [upper[block].view(), lower[block].view()];
            let pulled = if AGAIN {
                &pulled[(row + 1) * strip + block]
            } else {
                &NONE
            };
            let own = (springs, springs.first_of(row) + block);
            eliminate::<false, false, AGAIN>(ends, own, pulled, before, link);
        }
    }
    behind.fill(Behind::NONE);
    let links = links[..width * count].chunks_exact_mut(width);
    for (row, links) in links.enumerate().rev() {
        let lower = &mut blocks[(row + 1) * strip..][..strip];
        for (&block, (link, behind)) in chosen.iter().zip(links.iter_mut().zip(&mut *behind)) {
            let block = block as usize;
            substitute::<false>(lower[block].view_mut(), link, behind);
            if AGAIN {
                add(&mut pulled[(row + 1) * strip + block], &link.right);
            }
        }
    }
    for (&block, behind) in chosen.iter().zip(behind) {
        pull_head(blocks[block as usize].view_mut(), &behind.pull);
    }
}

#[inline(always)]
fn add(sum: &mut Lanes, other: &Lanes) {
    for l in 0..LANES {
        sum[l] += other[l];
    }
}
