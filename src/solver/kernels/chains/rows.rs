//! Chains within rows.
//!
//! Each lane has a strip of a row of its own: springs in a line, whose last leads to the strip of the next lane. So
//! each lane eliminates its strip alone, all but the last spring (the partition method, H. H. Wang 1981). The remaining
//! system has eight multipliers per row, each coupled to both lanes beside it. Cyclic reduction (R. W. Hockney 1965)
//! solves it in three steps, which make each multiplier independent of those one, two and four lanes away.
//!
//! # The floor
//! That of chains from row to row, and the coupling of a strip to the one before it: ten operations for eight springs.
//! The eight multipliers of a row cost five divisions and some 70 operations. That is little beside the eight blocks of
//! 64 columns, and as much as one of the two blocks of 16.

use super::{
    ends::{BESIDE, Ends, GROUP, Reduced, Wide},
    link::{Before, Behind, Link, SpringBand, after, damped, span, terms},
};
use crate::{
    cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W},
    solver::kernels::each::three,
};

/// Memory in which a group of rows is solved.
#[derive(Debug, Clone)]
pub(crate) struct RowScratch {
    /// Row by row, block by block.
    links: Vec<Link>,
    /// For each of them, its share of what the first spring of its strip takes from the strip before.
    spikes: Vec<Lanes>,
    strip: Strip,
    ends: Ends,
    /// By steps in turns.
    systems: [Reduced; 2],
}

impl RowScratch {
    pub fn new(strip: usize) -> Self {
        Self {
            links: vec![Link::NONE; strip * GROUP],
            spikes: vec![[0.0; LANES]; strip * GROUP],
            strip: Strip::NONE,
            ends: Ends::NONE,
            systems: [Reduced::NONE; 2],
        }
    }
}

/// The state of a lane's strip up to a spring.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct Strip {
    before: Before,
    /// Coupling of the spring to the last one of the strip before, as a fraction of that of the strip's first spring.
    off: Lanes,
    /// Contribution to the diagonal and the right side of that one, likewise.
    to_diagonal: Lanes,
    to_right: Lanes,
}

impl Strip {
    const NONE: Self = Self {
        before: Before::NONE,
        off: [0.0; LANES],
        to_diagonal: [0.0; LANES],
        to_right: [0.0; LANES],
    };
}

/// Eliminates the springs before: of a strip's first there are none; its last is not solved for.
#[inline(always)]
fn eliminate<const FIRST: bool, const LAST: bool, const DAMPED: bool, const AGAIN: bool>(
    [a, b]: [&View; 2],
    (springs, first): (&SpringBand, usize),
    block: usize,
    pulled: &[Lanes],
    strip: &mut Strip,
    link: &mut Link,
    spike: &mut Lanes,
) {
    let at = first + block;
    let (softness, hold) = (&springs.softness[at], &springs.hold[at]);
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
            after(right, [x, y, z], softness, pulled[block][l])
        } else {
            right
        };
        let before = &mut strip.before;
        let along = before.span[0][l] * x + before.span[1][l] * y + before.span[2][l] * z;
        let off = -a[W + l] * along;
        let share = if FIRST { 0.0 } else { off * before.pivot[l] };
        let to_strip = if FIRST { 1.0 } else { -share * strip.off[l] };
        let diagonal = if FIRST {
            diagonal
        } else {
            diagonal - off * share
        };
        let right = if FIRST {
            right
        } else {
            right - off * before.right[l]
        };
        let pivot = if LAST { diagonal } else { 1.0 / diagonal };
        let right = if LAST { right } else { right * pivot };
        [link.span[0][l], link.span[1][l], link.span[2][l]] = [x, y, z];
        [before.span[0][l], before.span[1][l], before.span[2][l]] = [x, y, z];
        [link.share[l], before.pivot[l]] = [share, pivot];
        [link.right[l], before.right[l]] = [right, right];
        strip.off[l] = to_strip;
        if !LAST {
            let part = to_strip * pivot;
            spike[l] = part;
            strip.to_diagonal[l] += to_strip * part;
            strip.to_right[l] += to_strip * right;
        }
    }
}

/// The springs of a row up to the reduced system, whose rows are to be `at` there.
#[inline(always)]
fn reduce<const DAMPED: bool, const AGAIN: bool>(
    row: &[Block],
    springs: (&SpringBand, usize),
    pulled: &[Lanes],
    links: &mut [Link],
    spikes: &mut [Lanes],
    strip: &mut Strip,
    (ends, system): (&mut Ends, &mut Reduced),
    at: usize,
) {
    let last = row.len() - 1;
    *strip = Strip::NONE;
    for (j, (link, spike)) in links.iter_mut().zip(spikes).enumerate() {
        let b = match row.get(j + 1) {
            Some(b) => b.view(),
            None => row[0].shifted(),
        };
        let between = [row[j].view(), b];
        macro_rules! eliminate {
            ($first:literal, $last:literal) => {
                eliminate::<$first, $last, DAMPED, AGAIN>(
                    between, springs, j, pulled, strip, link, spike,
                )
            };
        }
        match (j == 0, j == last) {
            (true, true) => eliminate!(true, true),
            (true, false) => eliminate!(true, false),
            (false, false) => eliminate!(false, false),
            (false, true) => eliminate!(false, true),
        }
    }
    let weight = row[0].view()[W..].first_chunk().expect("lanes");
    let [first_x, first_y, first_z] = &mut ends.first;
    let [last_x, last_y, last_z] = &mut ends.last;
    for (to, from) in [
        (&mut system.diagonal, &strip.before.pivot),
        (&mut system.right, &strip.before.right),
        (&mut system.off, &strip.off),
        (&mut ends.to_diagonal, &strip.to_diagonal),
        (&mut ends.to_right, &strip.to_right),
        (&mut ends.weight, weight),
        (first_x, &links[0].span[0]),
        (first_y, &links[0].span[1]),
        (first_z, &links[0].span[2]),
        (last_x, &strip.before.span[0]),
        (last_y, &strip.before.span[1]),
        (last_z, &strip.before.span[2]),
    ] {
        to[at..at + LANES].copy_from_slice(from);
    }
}

/// Solves for the multipliers, given those behind them and what the first spring takes from the strip before, and moves the
/// particles in between.
#[inline(always)]
fn substitute(b: &mut View, link: &mut Link, spike: &Lanes, to_first: &Lanes, behind: &mut Behind) {
    for l in 0..LANES {
        let multiplier = link.right[l] - spike[l] * to_first[l] - behind.given[l];
        link.right[l] = multiplier;
        behind.given[l] = link.share[l] * multiplier;
        let [x, y, z] = three(|axis| link.span[axis][l] * multiplier);
        b[DX + l] += b[W + l] * (x - behind.pull[0][l]);
        b[DY + l] += b[W + l] * (y - behind.pull[1][l]);
        b[DZ + l] += b[W + l] * (z - behind.pull[2][l]);
        [behind.pull[0][l], behind.pull[1][l], behind.pull[2][l]] = [x, y, z];
    }
}

/// Moves the first particles of strips.
#[inline(always)]
fn pull_first(a: &mut View, before: [&Lanes; 3], behind: &[Lanes; 3]) {
    for l in 0..LANES {
        a[DX + l] += a[W + l] * (before[0][l] - behind[0][l]);
        a[DY + l] += a[W + l] * (before[1][l] - behind[1][l]);
        a[DZ + l] += a[W + l] * (before[2][l] - behind[2][l]);
    }
}

/// Solves a row, of which the multipliers of the last springs are known.
#[inline(always)]
fn pull_row(
    row: &mut [Block],
    links: &mut [Link],
    spikes: &[Lanes],
    (ends, system): (&Ends, &Reduced),
    at: usize,
) {
    let lanes = |wide: &Wide, at: usize| -> Lanes { *wide[at..].first_chunk().expect("lanes") };
    let last = row.len() - 1;
    let multiplier = lanes(&system.right, at);
    let mut behind = Behind::NONE;
    behind.pull = three(|axis| lanes(&ends.pull[axis], at));
    links[last].right = multiplier;
    let shares = links[last].share.iter().zip(&multiplier);
    for (given, (share, multiplier)) in behind.given.iter_mut().zip(shares) {
        *given = share * multiplier;
    }
    let to_first = lanes(&ends.off, at);
    for j in (0..last).rev() {
        let b = row[j + 1].view_mut();
        substitute(b, &mut links[j], &spikes[j], &to_first, &mut behind);
    }
    let before = three(|axis| lanes(&ends.pull[axis], at - 1));
    pull_first(row[0].view_mut(), before.each_ref(), &behind.pull);
}

/// Rows of a grid, of which some are solved.
pub(crate) struct RowChains<'a> {
    /// Rows that lie one below the other.
    pub blocks: &'a mut [Block],
    /// The number of the first of them, and of all of the grid's.
    pub first: usize,
    pub of: usize,
    /// The numbers of those that are solved.
    pub numbers: &'a [u32],
    pub scratch: &'a mut RowScratch,
    /// For elastic springs: the multipliers of those of each of the rows (m kg); else empty.
    pub pulled: &'a mut [Lanes],
}

/// Solves the chains within rows, with the springs of a row on the grid's border, and of one that is not.
#[inline(always)]
pub(crate) fn solve_rows(rows: &mut RowChains, springs: &[SpringBand; 2]) {
    solve::<false, false>(rows, springs);
}

/// The same with damping along them.
#[inline(always)]
pub(crate) fn solve_damped_rows(rows: &mut RowChains, springs: &[SpringBand; 2]) {
    solve::<true, false>(rows, springs);
}

/// The same of elastic springs, which go on from what they have pulled with.
#[inline(always)]
pub(crate) fn solve_rows_again(rows: &mut RowChains, springs: &[SpringBand; 2]) {
    solve::<false, true>(rows, springs);
}

#[inline(always)]
fn solve<const DAMPED: bool, const AGAIN: bool>(
    rows: &mut RowChains,
    [border, inner]: &[SpringBand; 2],
) {
    let RowChains {
        blocks,
        first,
        of,
        numbers,
        scratch,
        pulled,
    } = rows;
    let (first, last) = (*first, *of - 1);
    let strip = scratch.links.len() / GROUP;
    let springs_of = |row: usize| {
        let is_border = row == 0 || row == last;
        let springs = if is_border { border } else { inner };
        (springs, springs.first_of(row))
    };
    let blocks_of = |row: usize| (row - first) * strip..(row - first + 1) * strip;
    let RowScratch {
        links,
        spikes,
        strip: state,
        ends,
        systems,
    } = &mut **scratch;
    for numbers in numbers.chunks(GROUP) {
        if numbers.len() < GROUP {
            (*ends, systems[0]) = (Ends::NONE, Reduced::NONE);
        }
        let parts = links
            .chunks_exact_mut(strip)
            .zip(spikes.chunks_exact_mut(strip));
        for (at, (&row, (links, spikes))) in numbers.iter().zip(parts).enumerate() {
            let (row, system) = (row as usize, (&mut *ends, &mut systems[0]));
            let own = blocks_of(row);
            let at = BESIDE + at * LANES;
            let pulled: &[Lanes] = if AGAIN { &pulled[own.clone()] } else { &[] };
            let state = &mut *state;
            reduce::<DAMPED, AGAIN>(
                &blocks[own],
                springs_of(row),
                pulled,
                links,
                spikes,
                state,
                system,
                at,
            );
        }
        ends.solve(systems);
        let parts = links
            .chunks_exact_mut(strip)
            .zip(spikes.chunks_exact(strip));
        for (at, (&row, (links, spikes))) in numbers.iter().zip(parts).enumerate() {
            let own = blocks_of(row as usize);
            let reduced = (&*ends, &systems[0]);
            pull_row(
                &mut blocks[own.clone()],
                links,
                spikes,
                reduced,
                BESIDE + at * LANES,
            );
            if let Some(pulled) = pulled.get_mut(own) {
                note_pull::<AGAIN>(pulled, links);
            }
        }
    }
}

/// Notes the multipliers of a row's springs, with those before if it is solved again.
#[inline(always)]
fn note_pull<const AGAIN: bool>(pulled: &mut [Lanes], links: &[Link]) {
    for (pulled, link) in pulled.iter_mut().zip(links) {
        for (pulled, right) in pulled.iter_mut().zip(link.right) {
            let before = if AGAIN { *pulled } else { 0.0 };
            *pulled = before + right;
        }
    }
}
