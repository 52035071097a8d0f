//! One sub-step over a grid: all stages, each a few rows behind the one before, in one pass down the rows.
//!
//! That gives to the last bit what one stage after the other over the whole cloth would, since a stage takes a
//! row only when the stage before is done with it and its neighbours; but the rows stay in the first cache.

use super::{
    instructions::Instructions,
    kernel::{commit, integrate, measure, relax},
    tether::{Anchors, Tethers},
};
use crate::cloth::{Block, ClothGrid, Compliances, Lanes, Layout, rest_length};

/// What is added to w_a + w_b (1/kg): nothing to speak of, but it keeps a spring between two pins from dividing
/// by zero.
pub(super) const LEAST_SOFTNESS: f32 = 1.0e-18;

/// What is done to a group of rows at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Verlet, and the springs within a row.
    Arrive,
    /// Vertical bend springs: of every four rows the first two, or the last two.
    BendDown(usize),
    /// Vertical springs from even rows, or from odd ones.
    Down(usize),
    /// Both diagonals, likewise.
    Diagonal(usize),
    /// Tethers; displacements become positions.
    Finish,
    /// The lengths of the springs from even rows and within all, or from odd rows.
    Measure(usize),
}

impl Stage {
    /// Rows in a group, and in the first one if that is shorter.
    fn group(self) -> (usize, usize) {
        match self {
            Self::Arrive | Self::Finish => (1, 0),
            Self::Down(part) | Self::Diagonal(part) | Self::Measure(part) => (2, part),
            Self::BendDown(part) => (4, 2 * part),
        }
    }

    /// Where the group that begins in `row` ends.
    fn end_of(self, row: usize, rows: usize) -> usize {
        let (size, first) = self.group();
        let end = if row < first { first } else { row + size };
        end.min(rows)
    }

    /// The last end of a group that is not beyond `row`, and the first that is not before it.
    fn ends_around(self, row: usize, rows: usize) -> (usize, usize) {
        let (size, first) = self.group();
        if row == rows {
            return (rows, rows);
        }
        if row < first {
            return (0, if row == 0 { 0 } else { first.min(rows) });
        }
        let before = first + (row - first) / size * size;
        let after = first + (row - first).next_multiple_of(size);
        (before, after.min(rows))
    }
}

const STAGES: usize = 10;

/// The most stages that can be: an order in which stiff springs have the last word.
const ORDER: [Stage; STAGES] = [
    Stage::Arrive,
    Stage::BendDown(0),
    Stage::BendDown(1),
    Stage::Down(0),
    Stage::Down(1),
    Stage::Diagonal(0),
    Stage::Diagonal(1),
    Stage::Finish,
    Stage::Measure(0),
    Stage::Measure(1),
];

/// From which row to which each stage goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    from: [usize; STAGES],
    to: [usize; STAGES],
}

impl Span {
    fn whole(rows: usize) -> Self {
        Self {
            from: [0; STAGES],
            to: [rows; STAGES],
        }
    }

    /// What can be done with rows `start..end` alone, whatever happens to the others at the same time.
    fn inside(start: usize, end: usize, rows: usize) -> Self {
        let mut span = Self::whole(rows);
        let (mut from, mut to) = (start, end);
        for (index, stage) in ORDER.into_iter().enumerate() {
            from = stage.ends_around(from, rows).1;
            to = stage.ends_around(to, rows).0;
            (span.from[index], span.to[index]) = (from, to);
        }
        span
    }

    /// What is left to do between two neighbours.
    fn between(before: &Self, after: &Self) -> Self {
        Self {
            from: before.to,
            to: after.from,
        }
    }
}

/// Springs that lie alike: one block of them for each block of a row.
#[derive(Debug, Clone, PartialEq)]
struct Run {
    rest_square: f32,
    /// Compliance (m/N), infinite where there is no spring.
    compliance: Vec<Lanes>,
    /// α/Δt² (1/kg).
    softness: Vec<Lanes>,
}

impl Run {
    /// The springs that begin in `row` of `grid`; one row stands for all like it.
    fn new(
        grid: &ClothGrid,
        layout: Layout,
        compliances: &Compliances,
        step: (u32, i32),
        row: u32,
    ) -> Self {
        let compliance = |block: usize, lane: usize| {
            let column = layout.column(block, lane)?;
            let end = column.checked_add_signed(step.1)?;
            let row = row.min(grid.rows().saturating_sub(1));
            (end < grid.columns()).then_some(())?;
            compliances.of_strip(grid, step, (row, column))
        };
        let lanes = |block: usize| {
            std::array::from_fn(|lane| compliance(block, lane).unwrap_or(f32::INFINITY))
        };
        let rest = rest_length(grid, step);
        let compliance: Vec<Lanes> = (0..layout.strip as usize).map(lanes).collect();
        Self {
            rest_square: rest * rest,
            softness: compliance.clone(),
            compliance,
        }
    }

    fn soften(&mut self, inverse_dt2: f32) {
        for (softness, compliance) in self.softness.iter_mut().zip(&self.compliance) {
            for (softness, compliance) in softness.iter_mut().zip(compliance) {
                *softness = compliance * inverse_dt2 + LEAST_SOFTNESS;
            }
        }
    }
}

/// A grid's springs as the sub-steps want them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GridSweep {
    layout: Layout,
    /// Within a row: one on a border, one that is not.
    across: [Run; 2],
    down: Run,
    diagonal: Run,
    bend_across: [Run; 2],
    bend_down: Run,
    has_shear: bool,
    has_bend: bool,
    /// The Δt (s) that softnesses hold for.
    substep: f32,
}

/// What is the same for all rows of a sub-step.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    pub kept: f32,
    pub acceleration_dt2: [f32; 3],
    pub tethers: &'a Tethers,
    pub anchors: &'a Anchors,
    /// Whether lengths are measured, too.
    pub measures: bool,
}

/// The largest squared lengths found (m²), lane by lane.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Longest {
    across: Lanes,
    down: Lanes,
    diagonal: Lanes,
}

impl Longest {
    fn merge(&mut self, other: &Self) {
        for (a, b) in [
            (&mut self.across, &other.across),
            (&mut self.down, &other.down),
            (&mut self.diagonal, &other.diagonal),
        ] {
            for (a, b) in a.iter_mut().zip(b) {
                *a = a.max(*b);
            }
        }
    }
}

impl GridSweep {
    pub fn new(grid: &ClothGrid, compliances: &Compliances) -> Self {
        let layout = Layout::new(grid.columns(), grid.rows());
        let run = |step, row| Run::new(grid, layout, compliances, step, row);
        // With two rows both are borders, and the second kind is not asked for.
        Self {
            layout,
            across: [run((0, 1), 0), run((0, 1), 1)],
            down: run((1, 0), 0),
            diagonal: run((1, 1), 0),
            bend_across: [run((0, 2), 0), run((0, 2), 1)],
            bend_down: run((2, 0), 0),
            has_shear: compliances.shear.is_finite(),
            has_bend: compliances.bend.is_finite(),
            substep: 0.0,
        }
    }

    /// Takes over the length of a sub-step (s).
    pub fn soften(&mut self, substep: f32) {
        if self.substep == substep {
            return;
        }
        self.substep = substep;
        let inverse_dt2 = 1.0 / (substep * substep);
        let within = self.across.iter_mut().chain(&mut self.bend_across);
        let between = [&mut self.down, &mut self.diagonal, &mut self.bend_down];
        for run in within.chain(between) {
            run.soften(inverse_dt2);
        }
    }

    /// One sub-step. With several `bands` of rows, each is done by a task of its own as far as it can be alone,
    /// then what is left between them: the same operations on each particle in the same order.
    pub fn substep(
        &self,
        blocks: &mut [Block],
        motion: Motion,
        bands: usize,
        instructions: Instructions,
    ) -> Longest {
        let rows = self.layout.rows as usize;
        let mut longest = Longest::default();
        let bands = bands.min(rows / LEAST_ROWS).min(MOST_BANDS);
        if bands <= 1 {
            instructions.wave(self, blocks, 0, &Span::whole(rows), motion, &mut longest);
            return longest;
        }
        let border = |band: usize| rows * band / bands;
        let span = |band: usize| Span::inside(border(band), border(band + 1), rows);
        let mut found = [longest; MOST_BANDS];
        bevy::tasks::ComputeTaskPool::get_or_init(Default::default).scope(|scope| {
            let mut rest = &mut *blocks;
            for (band, found) in found.iter_mut().enumerate().take(bands) {
                let first = border(band);
                let count = border(band + 1) - first;
                let (own, others) = rest.split_at_mut(count * self.layout.strip as usize);
                rest = others;
                let mut run =
                    move || instructions.wave(self, own, first, &span(band), motion, found);
                if band + 1 < bands {
                    scope.spawn(async move { run() });
                } else {
                    // The last one is this thread's own.
                    run();
                }
            }
        });
        for band in 1..bands {
            let left = Span::between(&span(band - 1), &span(band));
            instructions.wave(self, blocks, 0, &left, motion, &mut longest);
        }
        for found in &found[..bands] {
            longest.merge(found);
        }
        longest
    }

    /// Measures all springs.
    #[inline(always)]
    pub fn measure(&self, blocks: &[Block]) -> Longest {
        let mut longest = Longest::default();
        let strip = self.layout.strip as usize;
        for (row, upper) in blocks.chunks_exact(strip).enumerate() {
            self.measure_within(upper, &mut longest);
            if let Some(lower) = blocks.get((row + 1) * strip..(row + 2) * strip) {
                self.measure_between(upper, lower, &mut longest);
            }
        }
        longest
    }

    /// The largest length over rest length of structural springs, and of structural and shear springs.
    pub fn ratios(&self, longest: &Longest) -> (f32, f32) {
        let ratio = |lanes: &Lanes, run: &Run| {
            (lanes.iter().copied().fold(0.0, f32::max) / run.rest_square).sqrt()
        };
        let structural =
            ratio(&longest.across, &self.across[0]).max(ratio(&longest.down, &self.down));
        (
            structural,
            structural.max(ratio(&longest.diagonal, &self.diagonal)),
        )
    }

    #[inline(always)]
    fn measure_within(&self, row: &[Block], longest: &mut Longest) {
        let softness = &self.across[0].softness;
        for (pair, softness) in row.windows(2).zip(softness) {
            measure(
                pair[0].view(),
                pair[1].view(),
                softness,
                &mut longest.across,
            );
        }
        if let ([first, .., last], Some(softness)) = (row, softness.last()) {
            measure(last.view(), first.shifted(), softness, &mut longest.across);
        }
    }

    #[inline(always)]
    fn measure_between(&self, upper: &[Block], lower: &[Block], longest: &mut Longest) {
        for ((a, b), softness) in upper.iter().zip(lower).zip(&self.down.softness) {
            measure(a.view(), b.view(), softness, &mut longest.down);
        }
        if !self.has_shear {
            return;
        }
        let softness = &self.diagonal.softness;
        for (left, right) in [(upper, lower), (lower, upper)] {
            for ((a, b), softness) in left.iter().zip(&right[1..]).zip(softness) {
                measure(a.view(), b.view(), softness, &mut longest.diagonal);
            }
            if let (Some(a), Some(b), Some(softness)) =
                (left.last(), right.first(), softness.last())
            {
                measure(a.view(), b.shifted(), softness, &mut longest.diagonal);
            }
        }
    }

    /// All stages from row to row as `span` says. `blocks` begin with those of row `first`.
    #[inline(always)]
    pub(super) fn wave(
        &self,
        blocks: &mut [Block],
        first: usize,
        span: &Span,
        motion: Motion,
        longest: &mut Longest,
    ) {
        let rows = self.layout.rows as usize;
        let mut done = span.from;
        loop {
            let before = done;
            for (index, stage) in ORDER.into_iter().enumerate() {
                loop {
                    let (start, end) = (done[index], stage.end_of(done[index], rows));
                    // Where the stage before went as far as it may, another band goes on with it.
                    let is_ready = index == 0 || done[index - 1] >= end.min(span.to[index - 1]);
                    if start >= span.to[index] || !is_ready {
                        break;
                    }
                    self.run(stage, blocks, first, start..end, motion, longest);
                    done[index] = end;
                    if index == 0 {
                        break;
                    }
                }
            }
            if done == before {
                return;
            }
        }
    }

    #[inline(always)]
    fn run(
        &self,
        stage: Stage,
        blocks: &mut [Block],
        first: usize,
        rows: std::ops::Range<usize>,
        motion: Motion,
        longest: &mut Longest,
    ) {
        let strip = self.layout.strip as usize;
        let blocks = &mut blocks[(rows.start - first) * strip..(rows.end - first) * strip];
        match stage {
            Stage::Arrive => {
                integrate(blocks, motion.kept, motion.acceleration_dt2);
                let on_border = rows.start == 0 || rows.end == self.layout.rows as usize;
                let kind = usize::from(!on_border);
                if self.has_bend {
                    bend_across(blocks, &self.bend_across[kind]);
                }
                across(blocks, &self.across[kind]);
            }
            Stage::BendDown(_) if self.has_bend => {
                for row in 0..rows.len().saturating_sub(2) {
                    let (upper, lower) =
                        blocks[row * strip..(row + 3) * strip].split_at_mut(2 * strip);
                    down(&mut upper[..strip], lower, &self.bend_down);
                }
            }
            Stage::Down(_) if rows.len() == 2 => {
                let (upper, lower) = blocks.split_at_mut(strip);
                down(upper, lower, &self.down);
            }
            Stage::Diagonal(_) if rows.len() == 2 && self.has_shear => {
                let (upper, lower) = blocks.split_at_mut(strip);
                diagonal(upper, lower, &self.diagonal);
                diagonal(lower, upper, &self.diagonal);
            }
            Stage::Finish => {
                motion
                    .tethers
                    .pull(motion.anchors, blocks, rows.start * strip);
                commit(blocks);
            }
            Stage::Measure(part) if motion.measures => {
                if part == 0 {
                    for row in blocks.chunks_exact(strip) {
                        self.measure_within(row, longest);
                    }
                }
                if rows.len() == 2 {
                    let (upper, lower) = blocks.split_at(strip);
                    self.measure_between(upper, lower, longest);
                }
            }
            Stage::BendDown(_) | Stage::Down(_) | Stage::Diagonal(_) | Stage::Measure(_) => {}
        }
    }
}

/// Fewer rows a band than this, and what is left between two bands would be more than they hold.
const LEAST_ROWS: usize = 32;

/// More bands than this find no work worth a task.
const MOST_BANDS: usize = 16;

/// A row's horizontal springs: from even blocks, from odd ones, and from the last block into the first.
#[inline(always)]
fn across(row: &mut [Block], run: &Run) {
    let rest = |_| run.rest_square;
    for from in 0..2 {
        let pairs = row[from..].chunks_exact_mut(2);
        for (pair, softness) in pairs.zip(run.softness[from..].iter().step_by(2)) {
            if let [a, b] = pair {
                relax(a.view_mut(), b.view_mut(), rest, softness);
            }
        }
    }
    if let ([first, .., last], Some(softness)) = (row, run.softness.last()) {
        relax(last.view_mut(), first.shifted_mut(), rest, softness);
    }
}

/// A row's horizontal bend springs: of every four blocks from the first two, then from the last two, and from the
/// row's last two blocks into its first two.
#[inline(always)]
fn bend_across(row: &mut [Block], run: &Run) {
    let rest = |_| run.rest_square;
    let strip = row.len();
    for from in [0, 2] {
        let groups = row[from..].chunks_exact_mut(4);
        for (group, softness) in groups.zip(run.softness[from..].chunks(4)) {
            if let ([a, b, c, d], [soft_a, soft_b, ..]) = (group, softness) {
                relax(a.view_mut(), c.view_mut(), rest, soft_a);
                relax(b.view_mut(), d.view_mut(), rest, soft_b);
            }
        }
    }
    if let ([a, b, .., c, d], Some([soft_c, soft_d])) = (row, run.softness[..strip].last_chunk()) {
        relax(c.view_mut(), a.shifted_mut(), rest, soft_c);
        relax(d.view_mut(), b.shifted_mut(), rest, soft_d);
    }
}

#[inline(always)]
fn down(upper: &mut [Block], lower: &mut [Block], run: &Run) {
    let rest = |_| run.rest_square;
    for ((a, b), softness) in upper.iter_mut().zip(lower).zip(&run.softness) {
        relax(a.view_mut(), b.view_mut(), rest, softness);
    }
}

/// From each column of one row to the next column of the other.
#[inline(always)]
fn diagonal(left: &mut [Block], right: &mut [Block], run: &Run) {
    let rest = |_| run.rest_square;
    for ((a, b), softness) in left.iter_mut().zip(&mut right[1..]).zip(&run.softness) {
        relax(a.view_mut(), b.view_mut(), rest, softness);
    }
    if let (Some(a), Some(b), Some(softness)) =
        (left.last_mut(), right.first_mut(), run.softness.last())
    {
        relax(a.view_mut(), b.shifted_mut(), rest, softness);
    }
}
