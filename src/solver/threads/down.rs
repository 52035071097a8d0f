//! Threads that lead from row to row: columns, and both diagonals. The lanes are side by side, each in a thread of its own.

use super::link::{Equation, Family, Link, equation, from_left, from_right};
use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W};

/// What the springs of a block pull with: x, y and z (m kg).
pub(crate) type Pull = [Lanes; 3];

const NO_PULL: Pull = [[0.0; LANES]; 3];

/// Eliminates the springs before, whose last is `previous`.
#[inline(always)]
fn eliminate(a: &View, row: &Equation, previous: &Link, link: &mut Link) {
    for l in 0..LANES {
        let [x, y, z] = [0, 1, 2].map(|axis| row.way[axis][l]);
        let along = previous.way[0][l] * x + previous.way[1][l] * y + previous.way[2][l] * z;
        let off = -a[W + l] * along;
        let pivot = 1.0 / (row.diagonal[l] - off * (off * previous.pivot[l]));
        link.pivot[l] = pivot;
        link.right[l] = (row.right[l] - off * previous.right[l]) * pivot;
    }
    link.way = row.way;
}

/// Solves for the pull of a block's springs, given that of those after them, and moves the particles in between.
#[inline(always)]
fn substitute(b: &mut View, link: &Link, next: &Pull, pull: &mut Pull) {
    for l in 0..LANES {
        let [x, y, z] = [0, 1, 2].map(|axis| link.way[axis][l]);
        let along = x * next[0][l] + y * next[1][l] + z * next[2][l];
        let multiplier = link.right[l] + link.pivot[l] * (b[W + l] * along);
        let own = [x * multiplier, y * multiplier, z * multiplier];
        b[DX + l] += b[W + l] * (own[0] - next[0][l]);
        b[DY + l] += b[W + l] * (own[1] - next[1][l]);
        b[DZ + l] += b[W + l] * (own[2] - next[2][l]);
        [pull[0][l], pull[1][l], pull[2][l]] = own;
    }
}

/// Moves particles at the head of their threads.
#[inline(always)]
fn pull_head(a: &mut View, pull: &Pull) {
    for l in 0..LANES {
        a[DX + l] -= a[W + l] * pull[0][l];
        a[DY + l] -= a[W + l] * pull[1][l];
        a[DZ + l] -= a[W + l] * pull[2][l];
    }
}

#[inline(always)]
fn pull_lane(a: &mut Block, pull: &Pull, lane: usize) {
    let view = a.view_mut();
    for (axis, from) in [DX, DY, DZ].into_iter().enumerate() {
        view[from + lane] -= view[W + lane] * pull[axis][lane];
    }
}

/// Forward over springs of columns between two rows, those of the family from number `first` on.
#[inline(always)]
pub(crate) fn column_forward(
    upper: &[Block],
    lower: &[Block],
    previous: &[Link],
    links: &mut [Link],
    family: &Family,
    first: usize,
) {
    for (j, ((a, b), (before, link))) in upper
        .iter()
        .zip(lower)
        .zip(previous.iter().zip(links))
        .enumerate()
    {
        let row = equation(a.view(), b.view(), family, first + j);
        eliminate(a.view(), &row, before, link);
    }
}

/// Backward: moves the lower row.
#[inline(always)]
pub(crate) fn column_backward(
    lower: &mut [Block],
    links: &[Link],
    next: &[Pull],
    pulls: &mut [Pull],
) {
    for ((b, link), (next, pull)) in lower.iter_mut().zip(links).zip(next.iter().zip(pulls)) {
        substitute(b.view_mut(), link, next, pull);
    }
}

/// The first row of columns or diagonals.
#[inline(always)]
pub(crate) fn column_heads(first: &mut [Block], pulls: &[Pull]) {
    for (a, pull) in first.iter_mut().zip(pulls) {
        pull_head(a.view_mut(), pull);
    }
}

/// Diagonals from each column of the upper row to the next column of the lower.
#[inline(always)]
pub(crate) fn right_forward(
    upper: &[Block],
    lower: &[Block],
    previous: &[Link],
    links: &mut [Link],
    family: &Family,
) {
    let last = links.len() - 1;
    let wrapped = previous[last].moved_right();
    if last == 0 {
        let row = equation(upper[0].view(), lower[0].shifted(), family, 0);
        eliminate(upper[0].view(), &row, &wrapped, &mut links[0]);
        return;
    }
    let row = equation(upper[0].view(), lower[1].view(), family, 0);
    eliminate(upper[0].view(), &row, &wrapped, &mut links[0]);
    let ends = upper[1..].iter().zip(&lower[2..]);
    for (j, ((a, b), (before, link))) in ends.zip(previous.iter().zip(&mut links[1..])).enumerate()
    {
        let row = equation(a.view(), b.view(), family, j + 1);
        eliminate(a.view(), &row, before, link);
    }
    let row = equation(upper[last].view(), lower[0].shifted(), family, last);
    eliminate(
        upper[last].view(),
        &row,
        &previous[last - 1],
        &mut links[last],
    );
}

/// Backward: moves the lower row, but for its first column.
#[inline(always)]
pub(crate) fn right_backward(
    lower: &mut [Block],
    links: &[Link],
    next: &[Pull],
    pulls: &mut [Pull],
) {
    let last = links.len() - 1;
    for j in 0..last {
        substitute(
            lower[j + 1].view_mut(),
            &links[j],
            &next[j + 1],
            &mut pulls[j],
        );
    }
    let wrapped = [0, 1, 2].map(|axis| from_right(&next[0][axis]));
    substitute(
        lower[0].shifted_mut(),
        &links[last],
        &wrapped,
        &mut pulls[last],
    );
    // Its first column begins a thread.
    pull_lane(&mut lower[0], &next[0], 0);
}

/// Diagonals from each column of the lower row up to the next column of the upper; a thread leads down from right to left.
#[inline(always)]
pub(crate) fn left_forward(
    upper: &[Block],
    lower: &[Block],
    previous: &[Link],
    links: &mut [Link],
    family: &Family,
) {
    let last = links.len() - 1;
    for j in 0..last {
        let row = equation(upper[j + 1].view(), lower[j].view(), family, j);
        eliminate(upper[j + 1].view(), &row, &previous[j + 1], &mut links[j]);
    }
    let row = equation(upper[0].shifted(), lower[last].view(), family, last);
    eliminate(
        upper[0].shifted(),
        &row,
        &previous[0].moved_left(),
        &mut links[last],
    );
}

/// Backward: moves the lower row. Where a thread begins, at its last column, no spring leads to.
#[inline(always)]
pub(crate) fn left_backward(
    lower: &mut [Block],
    links: &[Link],
    next: &[Pull],
    pulls: &mut [Pull],
) {
    let last = links.len() - 1;
    let wrapped = [0, 1, 2].map(|axis| from_left(&next[last][axis]));
    substitute(lower[0].view_mut(), &links[0], &wrapped, &mut pulls[0]);
    let each = lower[1..].iter_mut().zip(&links[1..]);
    for ((b, link), (next, pull)) in each.zip(next.iter().zip(&mut pulls[1..])) {
        substitute(b.view_mut(), link, next, pull);
    }
}

/// The first row of diagonals that lead down to the left.
#[inline(always)]
pub(crate) fn left_heads(first: &mut [Block], pulls: &[Pull]) {
    let last = pulls.len() - 1;
    for j in 0..last {
        pull_head(first[j + 1].view_mut(), &pulls[j]);
    }
    pull_head(first[0].shifted_mut(), &pulls[last]);
}

/// No spring at all.
#[inline(always)]
pub(crate) fn clear(links: &mut [Link], pulls: &mut [Pull]) {
    links.fill(Link::NONE);
    pulls.fill(NO_PULL);
}
