//! One sub-step over a grid: all stages, each a few rows behind the one before, in one pass down the rows.
//!
//! The result is the same, to the last bit, as of one stage after the other over the whole cloth. A stage takes a row
//! only when the stage before is done with it and its neighbours. But the rows stay in the first cache.

use super::{
    Stretch,
    bands::{MAX_BANDS, pool},
    kernel::{Kernels, Longest},
    pace::Pace,
    run::Run,
    sweep::{Motion, Sweep, Swept},
};
use crate::cloth::{Block, ClothGrid, Compliances, Lanes, Layout};

/// The work on a group of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Work {
    /// The springs within a row.
    Across,
    /// Vertical springs from even rows, or from odd ones.
    Down,
    /// Both diagonals, likewise.
    Diagonal,
    /// Tethers; displacements become positions.
    Finish,
    /// The lengths of the springs from even rows and within all rows.
    MeasureEven,
    /// The lengths of the springs from odd rows.
    MeasureOdd,
}

/// A pass down the rows, one group of them after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stage {
    work: Work,
    /// Rows in a group.
    size: usize,
    /// Rows in the first group, if that is shorter; else 0.
    first: usize,
}

impl Stage {
    /// Where the group that begins in `row` ends.
    #[inline]
    fn end_of(self, row: usize, rows: usize) -> usize {
        let end = if row < self.first {
            self.first
        } else {
            row + self.size
        };
        end.min(rows)
    }

    /// The last end of a group that is not beyond `row`, and the first that is not before it.
    fn ends_around(self, row: usize, rows: usize) -> (usize, usize) {
        if row == rows {
            return (rows, rows);
        }
        if row < self.first {
            let after = if row == 0 { 0 } else { self.first.min(rows) };
            return (0, after);
        }
        let inside = row - self.first;
        let before = self.first + inside / self.size * self.size;
        let after = self.first + inside.next_multiple_of(self.size);
        (before, after.min(rows))
    }
}

const fn stage(work: Work, size: usize, first: usize) -> Stage {
    Stage { work, size, first }
}

const STAGES: usize = 8;

/// All stages that can be, in an order in which stiff springs have the last word.
const ORDER: [Stage; STAGES] = [
    stage(Work::Across, 1, 0),
    stage(Work::Down, 2, 0),
    stage(Work::Down, 2, 1),
    stage(Work::Diagonal, 2, 0),
    stage(Work::Diagonal, 2, 1),
    stage(Work::Finish, 1, 0),
    stage(Work::MeasureEven, 2, 0),
    stage(Work::MeasureOdd, 2, 1),
];

/// From which row to which each stage goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Span {
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

    /// The work that can be done with rows `start..end` alone, independently of the others.
    fn inside(stages: &[Stage], start: usize, end: usize, rows: usize) -> Self {
        let mut span = Self::whole(rows);
        let (mut from, mut to) = (start, end);
        for (index, stage) in stages.iter().enumerate() {
            from = stage.ends_around(from, rows).1;
            to = stage.ends_around(to, rows).0;
            (span.from[index], span.to[index]) = (from, to);
        }
        span
    }

    /// The remaining work between two neighbours.
    fn between(before: &Self, after: &Self) -> Self {
        Self {
            from: before.to,
            to: after.from,
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
    /// Those of [`ORDER`] for which there are springs.
    stages: Vec<Stage>,
    has_shear: bool,
    /// That softnesses hold for.
    pace: Pace,
}

impl GridSweep {
    pub fn new(grid: &ClothGrid, compliances: &Compliances) -> Self {
        let layout = Layout::new(grid.columns(), grid.rows());
        let has_shear = compliances.shear.is_finite();
        let run = |step, row| Run::new(grid, layout, compliances, step, row);
        // With two rows both are borders, and the second kind is not asked for.
        Self {
            layout,
            across: [run((0, 1), 0), run((0, 1), 1)],
            down: run((1, 0), 0),
            diagonal: run((1, 1), 0),
            stages: ORDER
                .into_iter()
                .filter(|stage| match stage.work {
                    Work::Diagonal => has_shear,
                    _ => true,
                })
                .collect(),
            has_shear,
            pace: Pace::default(),
        }
    }

    /// How many bands there are at most where some are wanted.
    fn bands(&self, wanted: usize) -> usize {
        let rows = self.layout.rows as usize;
        wanted.min(rows / MIN_ROWS).min(MAX_BANDS)
    }

    /// The largest length over rest length of structural springs, and of structural and shear springs.
    fn stretch(&self, longest: &Longest) -> Stretch {
        let ratio = |lanes: &Lanes, run: &Run| {
            (lanes.iter().copied().fold(0.0, f32::max) / run.rest_square).sqrt()
        };
        let structural =
            ratio(&longest.across, &self.across[0]).max(ratio(&longest.down, &self.down));
        let bound = structural.max(ratio(&longest.diagonal, &self.diagonal));
        Stretch::of_ratios(structural, bound)
    }

    /// Takes over what the sub-step is, but for damping along springs.
    fn soften(&mut self, pace: Pace) {
        if self.pace == pace {
            return;
        }
        self.pace = pace;
        let between = [&mut self.down, &mut self.diagonal];
        for run in self.across.iter_mut().chain(between) {
            run.soften(pace.inverse_weight);
        }
    }

    /// One sub-step. With several `bands` of rows, each is done by a task of its own as far as it can be alone, then
    /// the remaining work between them: the same operations on each particle in the same order.
    fn sweep(&self, blocks: &mut [Block], motion: &Motion, bands: usize) -> Longest {
        let rows = self.layout.rows as usize;
        let mut longest = Longest::default();
        let bands = self.bands(bands);
        if bands <= 1 {
            self.run_pipeline(blocks, 0, &Span::whole(rows), motion, &mut longest);
            return longest;
        }
        let border = |band: usize| rows * band / bands;
        let span = |band: usize| Span::inside(&self.stages, border(band), border(band + 1), rows);
        let mut found = [longest; MAX_BANDS];
        pool().scope(|scope| {
            let mut rest = &mut *blocks;
            for (band, found) in found.iter_mut().enumerate().take(bands) {
                let first = border(band);
                let count = border(band + 1) - first;
                let (own, others) = rest.split_at_mut(count * self.layout.strip as usize);
                rest = others;
                let mut run = move || self.run_pipeline(own, first, &span(band), motion, found);
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
            self.run_pipeline(blocks, 0, &left, motion, &mut longest);
        }
        for found in &found[..bands] {
            longest.merge(found);
        }
        longest
    }

    fn measure_between(
        &self,
        upper: &[Block],
        lower: &[Block],
        kernels: &Kernels,
        longest: &mut Longest,
    ) {
        (kernels.measure_down)(upper, lower, &self.down, longest);
        if self.has_shear {
            (kernels.measure_diagonal)(upper, lower, &self.diagonal, longest);
            (kernels.measure_diagonal)(lower, upper, &self.diagonal, longest);
        }
    }

    /// All stages from row to row as `span` says. `blocks` begin with those of row `first`.
    fn run_pipeline(
        &self,
        blocks: &mut [Block],
        first: usize,
        span: &Span,
        motion: &Motion,
        longest: &mut Longest,
    ) {
        let rows = self.layout.rows as usize;
        let measures = if motion.measures { 0 } else { 2 };
        let stages = &self.stages[..self.stages.len() - measures];
        let mut done = span.from;
        let mut goes_on = true;
        while goes_on {
            goes_on = false;
            for (index, stage) in stages.iter().enumerate() {
                loop {
                    let (start, end) = (done[index], stage.end_of(done[index], rows));
                    // Where the stage before went as far as it may, another band goes on with it.
                    let is_ready = index == 0 || done[index - 1] >= end.min(span.to[index - 1]);
                    if start >= span.to[index] || !is_ready {
                        break;
                    }
                    self.run(stage.work, blocks, first, start..end, motion, longest);
                    done[index] = end;
                    goes_on = true;
                    if index == 0 {
                        break;
                    }
                }
            }
        }
    }

    fn run(
        &self,
        work: Work,
        blocks: &mut [Block],
        first: usize,
        rows: std::ops::Range<usize>,
        motion: &Motion,
        longest: &mut Longest,
    ) {
        let strip = self.layout.strip as usize;
        let blocks = &mut blocks[(rows.start - first) * strip..(rows.end - first) * strip];
        let kernels = motion.kernels;
        match work {
            Work::Across => {
                let on_border = rows.start == 0 || rows.end == self.layout.rows as usize;
                let kind = usize::from(!on_border);
                (kernels.across)(blocks, &self.across[kind]);
            }
            Work::Down => {
                // A first or last row alone has no partner.
                let (upper, lower) = blocks.split_at_mut(strip);
                (kernels.down)(upper, lower, &self.down);
            }
            Work::Diagonal => {
                let (upper, lower) = blocks.split_at_mut(strip);
                if !lower.is_empty() {
                    (kernels.diagonals)(upper, lower, &self.diagonal);
                }
            }
            Work::Finish => {
                let first = rows.start * strip;
                motion.tethers.pull(motion.anchors, blocks, first, kernels);
                (kernels.commit)(blocks, &mut longest.moved);
            }
            Work::MeasureEven | Work::MeasureOdd => {
                if work == Work::MeasureEven {
                    for row in blocks.chunks_exact(strip) {
                        (kernels.measure_within)(row, &self.across[0], longest);
                    }
                }
                let (upper, lower) = blocks.split_at(strip);
                if !lower.is_empty() {
                    self.measure_between(upper, lower, kernels, longest);
                }
            }
        }
    }
}

impl Sweep for GridSweep {
    fn set_pace(&mut self, pace: Pace) {
        self.soften(pace);
    }

    fn is_exact(&self) -> bool {
        false
    }

    fn bands(&self, wanted: usize) -> usize {
        self.bands(wanted)
    }

    fn substep(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) -> Swept {
        let longest = self.sweep(blocks, motion, bands);
        Swept {
            moved: longest.moved,
            stretch: motion.measures.then(|| self.stretch(&longest)),
            ripple: 0.0,
        }
    }

    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch {
        let mut longest = Longest::default();
        let strip = self.layout.strip as usize;
        for (row, upper) in blocks.chunks_exact(strip).enumerate() {
            (kernels.measure_within)(upper, &self.across[0], &mut longest);
            if let Some(lower) = blocks.get((row + 1) * strip..(row + 2) * strip) {
                self.measure_between(upper, lower, kernels, &mut longest);
            }
        }
        self.stretch(&longest)
    }

    fn boxed(&self) -> Box<dyn Sweep> {
        Box::new(self.clone())
    }
}

/// Smallest number of rows in a band: with fewer, the work between two bands would be larger than that within them.
const MIN_ROWS: usize = 32;
