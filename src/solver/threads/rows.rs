//! Threads within rows.
//!
//! Each lane has a strip of a row of its own: springs in a line, whose last leads to the strip of the next lane. So
//! each lane eliminates its strip alone, all but the last spring (the partition method, H. H. Wang 1981). The remaining
//! system has eight multipliers per row, each coupled to both lanes beside it. Cyclic reduction (R. W. Hockney 1965)
//! solves it in three steps, which make each multiplier independent of those one, two and four lanes away.
//!
//! # The floor
//! That of threads from row to row, and the coupling of a strip to the one before it: ten operations for eight springs.
//! The eight multipliers of a row cost five divisions and some 70 operations. That is little beside the eight blocks of
//! 64 columns, and as much as one of the two blocks of 16.

use super::link::{Before, Behind, Family, Link, damped, measure_given, terms, way};
use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W};

/// Rows that are worked on at once: while one waits for its divisions, others need not.
pub(super) const GROUP: usize = 8;

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

/// The lanes of all rows of a group, one after the other, and as many on either side as a step of the reduction looks at.
type Wide = [f32; BESIDE + GROUP * LANES + BESIDE];
const BESIDE: usize = 4;

/// The system for the last springs of strips. The last strip's leads nowhere: infinitely held, it takes nothing and hands on
/// nothing, so that rows need not be kept apart.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct Reduced {
    diagonal: Wide,
    /// Coupling to the lane before.
    off: Wide,
    right: Wide,
    /// One over the diagonal.
    inverse: Wide,
}

impl Reduced {
    const NONE: Self = Self {
        diagonal: [1.0; _],
        off: [0.0; _],
        right: [0.0; _],
        inverse: [1.0; _],
    };

    /// Makes each lane independent of those `DISTANCE` away; with them comes what they have to do with those beyond.
    #[inline(always)]
    fn without<const DISTANCE: usize>(&self, out: &mut Self) {
        for at in BESIDE..BESIDE + GROUP * LANES {
            let (left, right) = (at - DISTANCE, at + DISTANCE);
            let before = self.off[at] * self.inverse[left];
            let after = self.off[right] * self.inverse[right];
            let diagonal = self.diagonal[at] - self.off[at] * before - self.off[right] * after;
            out.right[at] = self.right[at] - before * self.right[left] - after * self.right[right];
            out.off[at] = -before * self.off[left];
            out.diagonal[at] = diagonal;
            out.inverse[at] = 1.0 / diagonal;
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

/// The first and last springs of a group's strips.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct Ends {
    /// Of the first particles (1/kg).
    weight: Wide,
    /// Of the first springs and of the last, in rest lengths.
    first: [Wide; 3],
    last: [Wide; 3],
    to_diagonal: Wide,
    to_right: Wide,
    /// Coupling of the first to the last of the strip before; then its share of that one's multiplier.
    off: Wide,
    /// Pull of the last ones (m kg).
    pull: [Wide; 3],
}

impl Ends {
    const NONE: Self = Self {
        weight: [0.0; _],
        first: [[0.0; _]; 3],
        last: [[0.0; _]; 3],
        to_diagonal: [0.0; _],
        to_right: [0.0; _],
        off: [0.0; _],
        pull: [[0.0; _]; 3],
    };

    /// Solves for the multipliers of the last springs, which are the right side then.
    #[inline(always)]
    fn solve(&mut self, [this, other]: &mut [Reduced; 2]) {
        for at in BESIDE..BESIDE + GROUP * LANES {
            let along = self.last[0][at - 1] * self.first[0][at]
                + self.last[1][at - 1] * self.first[1][at]
                + self.last[2][at - 1] * self.first[2][at];
            self.off[at] = -self.weight[at] * along;
            this.off[at] *= self.off[at];
        }
        for at in BESIDE..BESIDE + GROUP * LANES {
            let off = self.off[at + 1];
            let diagonal = this.diagonal[at] - off * (off * self.to_diagonal[at + 1]);
            this.diagonal[at] = diagonal;
            this.right[at] -= off * self.to_right[at + 1];
            this.inverse[at] = 1.0 / diagonal;
        }
        this.without::<1>(other);
        other.without::<2>(this);
        this.without::<4>(other);
        for at in BESIDE..BESIDE + GROUP * LANES {
            let multiplier = other.right[at] * other.inverse[at];
            this.right[at] = multiplier;
            self.pull[0][at] = self.last[0][at] * multiplier;
            self.pull[1][at] = self.last[1][at] * multiplier;
            self.pull[2][at] = self.last[2][at] * multiplier;
        }
        for at in BESIDE..BESIDE + GROUP * LANES {
            self.off[at] *= this.right[at - 1];
        }
    }
}

/// Eliminates the springs before: of a strip's first there are none; its last is not solved for.
#[inline(always)]
fn eliminate<const FIRST: bool, const LAST: bool, const DAMPED: bool>(
    [a, b]: [&View; 2],
    family: &Family,
    block: usize,
    strip: &mut Strip,
    link: &mut Link,
    spike: &mut Lanes,
) {
    let (softness, hold) = (&family.softness[block], &family.hold[block]);
    for l in 0..LANES {
        let [x, y, z] = way(a, b, family.inverse_rest, l);
        let weight = a[W + l] + b[W + l];
        let softness = if DAMPED {
            family.kept * softness[l]
        } else {
            softness[l]
        };
        let [diagonal, right] = terms([x, y, z], weight, softness, hold[l], family.rest);
        let right = if DAMPED {
            damped(right, [a, b], [x, y, z], family.kept, l)
        } else {
            right
        };
        let before = &mut strip.before;
        let along = before.way[0][l] * x + before.way[1][l] * y + before.way[2][l] * z;
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
        [link.way[0][l], link.way[1][l], link.way[2][l]] = [x, y, z];
        [before.way[0][l], before.way[1][l], before.way[2][l]] = [x, y, z];
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
fn reduce<const DAMPED: bool>(
    row: &[Block],
    family: &Family,
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
        match (j == 0, j == last) {
            (true, true) => eliminate::<true, true, DAMPED>(between, family, j, strip, link, spike),
            (true, false) => {
                eliminate::<true, false, DAMPED>(between, family, j, strip, link, spike);
            }
            (false, false) => {
                eliminate::<false, false, DAMPED>(between, family, j, strip, link, spike);
            }
            (false, true) => {
                eliminate::<false, true, DAMPED>(between, family, j, strip, link, spike);
            }
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
        (first_x, &links[0].way[0]),
        (first_y, &links[0].way[1]),
        (first_z, &links[0].way[2]),
        (last_x, &strip.before.way[0]),
        (last_y, &strip.before.way[1]),
        (last_z, &strip.before.way[2]),
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
        let [x, y, z] = [0, 1, 2].map(|axis| link.way[axis][l] * multiplier);
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
    behind.pull = [0, 1, 2].map(|axis| lanes(&ends.pull[axis], at));
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
    let before = [0, 1, 2].map(|axis| lanes(&ends.pull[axis], at - 1));
    pull_first(row[0].view_mut(), before.each_ref(), &behind.pull);
}

/// Rows that lie one below the other.
pub(crate) struct RowThreads<'a> {
    pub blocks: &'a mut [Block],
    /// For the first and the last of them: whether it is on the grid's border.
    pub is_border: [bool; 2],
    pub scratch: &'a mut RowScratch,
    /// Raised to the squares of the springs' elongations at their tension (m²).
    pub given: Option<&'a mut Lanes>,
}

/// Solves the threads within rows, with the springs of a row on the grid's border, and of one that is not.
#[inline(always)]
pub(crate) fn solve_rows(rows: &mut RowThreads, families: &[Family; 2]) {
    solve::<false>(rows, families);
}

/// The same with damping along them.
#[inline(always)]
pub(crate) fn solve_damped_rows(rows: &mut RowThreads, families: &[Family; 2]) {
    solve::<true>(rows, families);
}

#[inline(always)]
fn solve<const DAMPED: bool>(rows: &mut RowThreads, [border, inner]: &[Family; 2]) {
    let strip = border.hold.len();
    let count = rows.blocks.len() / strip;
    let [first, last] = rows.is_border;
    let family = |row: usize| {
        let is_border = (row == 0 && first) || (row + 1 == count && last);
        if is_border { border } else { inner }
    };
    let RowScratch {
        links,
        spikes,
        strip: state,
        ends,
        systems,
    } = &mut *rows.scratch;
    for (group, blocks) in rows.blocks.chunks_mut(strip * GROUP).enumerate() {
        if blocks.len() < strip * GROUP {
            (*ends, systems[0]) = (Ends::NONE, Reduced::NONE);
        }
        let springs = links
            .chunks_exact_mut(strip)
            .zip(spikes.chunks_exact_mut(strip));
        for (at, (row, (links, spikes))) in blocks.chunks_exact(strip).zip(springs).enumerate() {
            let (family, system) = (family(group * GROUP + at), (&mut *ends, &mut systems[0]));
            let at = BESIDE + at * LANES;
            reduce::<DAMPED>(row, family, links, spikes, state, system, at);
        }
        ends.solve(systems);
        let springs = links
            .chunks_exact_mut(strip)
            .zip(spikes.chunks_exact(strip));
        for (at, (row, (links, spikes))) in blocks.chunks_exact_mut(strip).zip(springs).enumerate()
        {
            pull_row(
                row,
                links,
                spikes,
                (&*ends, &systems[0]),
                BESIDE + at * LANES,
            );
            if let Some(given) = &mut rows.given {
                measure_given(links, &family(group * GROUP + at).softness, given);
            }
        }
    }
}
