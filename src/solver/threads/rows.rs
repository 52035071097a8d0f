//! Threads within rows.
//!
//! Of a row, each lane has a strip of its own, springs in a line whose last leads to the strip of the next lane. So each lane
//! eliminates its strip alone, all but the last spring (the partition method, H. H. Wang 1981): what is left are eight multipliers
//! a row, each of which has to do with those of both lanes beside it. They are found by cyclic reduction (R. W. Hockney 1965), in
//! three steps, in which each is made independent of those one, two and four lanes away.
//!
//! # The floor
//! As of threads from row to row, and besides, what links a strip to the one before it: nine operations for eight springs. The
//! eight multipliers of a row cost 40 operations and four divisions: as much as a third of a block's other work at 64², more
//! than half of it at 16².

use super::{
    down::{Before, Behind, pull_head},
    link::{Family, Link, measure_given, terms, way},
};
use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, View, W};

/// Rows that are worked on at once: while one waits for its divisions, others need not.
pub(super) const GROUP: usize = 8;

/// What a group of rows is solved in.
#[derive(Debug, Clone)]
pub(crate) struct RowScratch {
    /// Row by row, block by block.
    links: Vec<Link>,
    /// For each of them the part of the last multiplier of the strip before that it takes.
    spikes: Vec<Lanes>,
    systems: [Reduced; GROUP],
}

impl RowScratch {
    pub fn new(strip: usize) -> Self {
        Self {
            links: vec![Link::NONE; strip * GROUP],
            spikes: vec![[0.0; LANES]; strip * GROUP],
            systems: [Reduced::NONE; GROUP],
        }
    }
}

/// A number for each lane, and as many for lanes beside that there are not as a step of the reduction looks at.
type Wide = [f32; 2 * BESIDE + LANES];
const BESIDE: usize = 4;

/// The system for the last springs of a row's strips.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct Reduced {
    diagonal: Lanes,
    /// One over the diagonal.
    inverse: Wide,
    /// What has to do with the lane before.
    off: Wide,
    /// Right side; in the end the multipliers.
    right: Wide,
}

impl Reduced {
    const NONE: Self = Self {
        diagonal: [1.0; LANES],
        inverse: [0.0; _],
        off: [0.0; _],
        right: [0.0; _],
    };

    /// Makes each lane independent of those `distance` away; with them goes what they had to do with those beyond.
    #[inline(always)]
    fn without<const DISTANCE: usize>(&self, out: &mut Self) {
        for l in 0..LANES {
            let at = BESIDE + l;
            let (left, right) = (at - DISTANCE, at + DISTANCE);
            let before = self.off[at] * self.inverse[left];
            let after = self.off[right] * self.inverse[right];
            let diagonal = self.diagonal[l] - self.off[at] * before - self.off[right] * after;
            out.right[at] = self.right[at] - before * self.right[left] - after * self.right[right];
            out.off[at] = -before * self.off[left];
            out.diagonal[l] = diagonal;
            out.inverse[at] = 1.0 / diagonal;
        }
    }
}

/// What a lane knows of its strip up to a spring.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
struct Strip {
    before: Before,
    /// What the spring has to do with the last of the strip before.
    off: Lanes,
    /// What that one has to take over into its diagonal and its right side.
    diagonal: Lanes,
    right: Lanes,
}

/// Eliminates the springs before; the first of a strip has none, the last is left to the reduced system.
#[inline(always)]
fn eliminate<const FIRST: bool>(
    [a, b]: [&View; 2],
    family: &Family,
    block: usize,
    strip: &mut Strip,
    (link, spike): (&mut Link, &mut Lanes),
) {
    let (softness, hold) = (&family.softness[block], &family.hold[block]);
    let before = &mut strip.before;
    for l in 0..LANES {
        let [x, y, z] = way(a, b, family.inverse_rest, l);
        let weight = a[W + l] + b[W + l];
        let [diagonal, right] = terms([x, y, z], weight, softness[l], hold[l], family.rest);
        let along = before.way[0][l] * x + before.way[1][l] * y + before.way[2][l] * z;
        let off = -a[W + l] * along;
        let (share, to_strip) = if FIRST {
            (0.0, off)
        } else {
            let share = off * before.pivot[l];
            (share, -share * strip.off[l])
        };
        let (diagonal, right) = if FIRST {
            (diagonal, right)
        } else {
            (diagonal - off * share, right - off * before.right[l])
        };
        let pivot = 1.0 / diagonal;
        let right = right * pivot;
        let part = to_strip * pivot;
        [link.way[0][l], link.way[1][l], link.way[2][l]] = [x, y, z];
        [before.way[0][l], before.way[1][l], before.way[2][l]] = [x, y, z];
        [link.share[l], before.pivot[l]] = [share, pivot];
        [link.right[l], before.right[l]] = [right, right];
        strip.off[l] = to_strip;
        spike[l] = part;
        strip.diagonal[l] += to_strip * part;
        strip.right[l] += to_strip * right;
    }
}

/// The last spring of a strip, reduced to what it has to do with those of the other strips.
#[inline(always)]
fn eliminate_last<const FIRST: bool>(
    [a, b]: [&View; 2],
    family: &Family,
    block: usize,
    strip: &Strip,
    link: &mut Link,
    system: &mut Reduced,
) {
    let (softness, hold) = (&family.softness[block], &family.hold[block]);
    let before = &strip.before;
    // What the lane on the right leaves to this one's system comes from the lane behind: so from the last lane on.
    let mut right_lane = [0.0; 2];
    for l in (0..LANES).rev() {
        let [x, y, z] = way(a, b, family.inverse_rest, l);
        let weight = a[W + l] + b[W + l];
        let [diagonal, right] = terms([x, y, z], weight, softness[l], hold[l], family.rest);
        let along = before.way[0][l] * x + before.way[1][l] * y + before.way[2][l] * z;
        let off = -a[W + l] * along;
        let (share, to_strip) = if FIRST {
            (0.0, off)
        } else {
            let share = off * before.pivot[l];
            (share, -share * strip.off[l])
        };
        let (diagonal, right) = if FIRST {
            (diagonal, right)
        } else {
            (diagonal - off * share, right - off * before.right[l])
        };
        [link.way[0][l], link.way[1][l], link.way[2][l]] = [x, y, z];
        link.share[l] = share;
        let diagonal = diagonal - right_lane[0];
        system.off[BESIDE + l] = to_strip;
        system.right[BESIDE + l] = right - right_lane[1];
        system.diagonal[l] = diagonal;
        system.inverse[BESIDE + l] = 1.0 / diagonal;
        right_lane = [strip.diagonal[l], strip.right[l]];
    }
}

/// The way that leads to the first block of a row: that of the last block's springs, a lane on.
#[inline(always)]
fn way_before([a, b]: [&View; 2], family: &Family) -> [Lanes; 3] {
    let mut ways = [[0.0; LANES]; 3];
    let mut lane_before = [0.0; 3];
    for l in 0..LANES {
        [ways[0][l], ways[1][l], ways[2][l]] = lane_before;
        lane_before = way(a, b, family.inverse_rest, l);
    }
    ways
}

/// The springs of a row up to the reduced system.
#[inline(always)]
fn reduce(
    row: &[Block],
    family: &Family,
    links: &mut [Link],
    spikes: &mut [Lanes],
    system: &mut Reduced,
) {
    let last = row.len() - 1;
    let to_next = [row[last].view(), row[0].shifted()];
    let mut strip = Strip {
        before: Before::NONE,
        off: [0.0; LANES],
        diagonal: [0.0; LANES],
        right: [0.0; LANES],
    };
    strip.before.way = way_before(to_next, family);
    let (link, links) = links.split_last_mut().expect("a block");
    if last == 0 {
        return eliminate_last::<true>(to_next, family, 0, &strip, link, system);
    }
    for (j, springs) in links.iter_mut().zip(spikes).enumerate() {
        let ends = [row[j].view(), row[j + 1].view()];
        if j == 0 {
            eliminate::<true>(ends, family, j, &mut strip, springs);
        } else {
            eliminate::<false>(ends, family, j, &mut strip, springs);
        }
    }
    eliminate_last::<false>(to_next, family, last, &strip, link, system);
}

/// Solves for the multipliers, given those behind them and that of the strip before, and moves the particles in between.
#[inline(always)]
fn substitute(b: &mut View, link: &mut Link, spike: &Lanes, to_strip: &Lanes, behind: &mut Behind) {
    for l in 0..LANES {
        let multiplier = link.right[l] - spike[l] * to_strip[l] - behind.given[l];
        link.right[l] = multiplier;
        behind.given[l] = link.share[l] * multiplier;
        let [x, y, z] = [0, 1, 2].map(|axis| link.way[axis][l] * multiplier);
        b[DX + l] += b[W + l] * (x - behind.pull[0][l]);
        b[DY + l] += b[W + l] * (y - behind.pull[1][l]);
        b[DZ + l] += b[W + l] * (z - behind.pull[2][l]);
        [behind.pull[0][l], behind.pull[1][l], behind.pull[2][l]] = [x, y, z];
    }
}

/// Solves a row, of which the multipliers of the reduced system are known.
#[inline(always)]
fn pull_row(row: &mut [Block], links: &mut [Link], spikes: &[Lanes], system: &Reduced) {
    let last = row.len() - 1;
    let mut behind = Behind::NONE;
    links[last].right = *system.right[BESIDE..].first_chunk().expect("lanes");
    let to_strip = system.right[BESIDE - 1..].first_chunk().expect("lanes");
    let none = [0.0; LANES];
    substitute(
        row[0].shifted_mut(),
        &mut links[last],
        &none,
        to_strip,
        &mut behind,
    );
    for j in (0..last).rev() {
        substitute(
            row[j + 1].view_mut(),
            &mut links[j],
            &spikes[j],
            to_strip,
            &mut behind,
        );
    }
    pull_head(row[0].view_mut(), &behind.pull);
}

/// Rows that lie one below the other.
pub(crate) struct RowThreads<'a> {
    pub blocks: &'a mut [Block],
    /// For the first and the last of them: whether it is on the grid's border.
    pub is_border: [bool; 2],
    pub scratch: &'a mut RowScratch,
    /// To be raised to the squares of what springs give at their tension (m²).
    pub given: Option<&'a mut Lanes>,
}

/// Solves the threads within rows, with the springs of a row on the grid's border, and of one that is not.
#[inline(always)]
pub(crate) fn solve_rows(rows: &mut RowThreads, [border, inner]: &[Family; 2]) {
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
        systems,
    } = &mut *rows.scratch;
    for (group, blocks) in rows.blocks.chunks_mut(strip * GROUP).enumerate() {
        let of_rows = links
            .chunks_exact_mut(strip)
            .zip(spikes.chunks_exact_mut(strip));
        let of_rows = of_rows.zip(&mut *systems);
        for (at, (row, ((links, spikes), system))) in
            blocks.chunks_exact(strip).zip(of_rows).enumerate()
        {
            reduce(row, family(group * GROUP + at), links, spikes, system);
        }
        let systems = &mut systems[..blocks.len() / strip];
        let mut others = [Reduced::NONE; GROUP];
        for (from, to) in systems.iter().zip(&mut others) {
            from.without::<1>(to);
        }
        for (from, to) in others.iter().zip(&mut *systems) {
            from.without::<2>(to);
        }
        for (from, to) in systems.iter().zip(&mut others) {
            from.without::<4>(to);
        }
        for (from, to) in others.iter().zip(&mut *systems) {
            for at in BESIDE..BESIDE + LANES {
                to.right[at] = from.right[at] * from.inverse[at];
            }
        }
        let of_rows = links
            .chunks_exact_mut(strip)
            .zip(spikes.chunks_exact(strip));
        for (at, (row, ((links, spikes), system))) in blocks
            .chunks_exact_mut(strip)
            .zip(of_rows.zip(&*systems))
            .enumerate()
        {
            pull_row(row, links, spikes, system);
            if let Some(given) = &mut rows.given {
                measure_given(links, &family(group * GROUP + at).softness, given);
            }
        }
    }
}
