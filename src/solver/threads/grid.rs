//! The springs of a grid, thread by thread, in one band or several. A band consists of blocks side by side for threads
//! from row to row, and of rows for threads within rows.

use std::ops::Range;

use super::{
    beside::{Scratch, Threads},
    direction::Direction,
    link::Family,
    rows::{GROUP, RowScratch, RowThreads},
};
use crate::{
    cloth::{Block, ClothGrid, Compliances, LANES, Lanes, Layout, W},
    solver::{
        Stretch,
        bands::{MAX_BANDS, in_bands, take},
        kernel::{Kernels, Longest},
        pace::Pace,
        run::Run,
        sweep::{Motion, Sweep, Swept},
    },
};

/// Fewer rows a band than this, or fewer blocks of a row, and waiting for the others would take longer than the work.
const MIN_ROWS: usize = 32;
const MIN_BLOCKS: usize = 2;

/// The springs of a grid, thread by thread.
#[derive(Debug, Clone)]
pub(in crate::solver) struct ThreadSweep {
    layout: Layout,
    /// Within a row: one on a border, one that is not.
    across: [Family; 2],
    down: Family,
    /// If there are any.
    diagonal: Option<Family>,
    /// For measuring: within a row, down, diagonal.
    runs: [Run; 3],
    scratch: Scratch,
    /// One for each band.
    rows: Vec<RowScratch>,
    /// That softnesses hold for.
    pace: Pace,
    /// Largest stiffness over length of springs across and down (N/m²), 0 of those that don't give.
    ripple_stiffness: [f32; 2],
}

/// Results of a band.
#[derive(Default, Clone, Copy)]
struct Found {
    given: Lanes,
    moved: Lanes,
    longest: Longest,
}

impl ThreadSweep {
    pub fn new(grid: &ClothGrid, compliances: &Compliances) -> Self {
        let layout = Layout::new(grid.columns(), grid.rows());
        let strip = layout.strip as usize;
        let family = |step, row| Family::new(grid, layout, compliances, step, row);
        let mut run =
            [(0, 1), (1, 0), (1, 1)].map(|step| Run::new(grid, layout, compliances, step, 0));
        for run in &mut run {
            run.soften(1.0);
        }
        let across = [family((0, 1), 0), family((0, 1), 1)];
        let down = family((1, 0), 0);
        let ripple_stiffness =
            [&across[1], &down].map(|family| family.stiffness() * family.inverse_rest);
        Self {
            layout,
            across,
            down,
            ripple_stiffness,
            diagonal: compliances.shear.is_finite().then(|| family((1, 1), 0)),
            runs: run,
            scratch: Scratch::new(layout),
            rows: vec![RowScratch::new(strip)],
            pace: Pace::default(),
        }
    }

    /// Solves all threads that lead from row to row in one direction. Raises `given` to the squares of the elongations
    /// of their springs at their tension (m²).
    pub(super) fn solve_down(
        &mut self,
        blocks: &mut [Block],
        direction: Direction,
        kernels: &Kernels,
        given: Option<&mut Lanes>,
    ) {
        let Some(family) = (match direction {
            Direction::Down => Some(&self.down),
            Direction::Right | Direction::Left => self.diagonal.as_ref(),
        }) else {
            return;
        };
        let strip = self.layout.strip as usize;
        let mut threads = self.scratch.all(direction, strip, blocks);
        solve(&mut threads, family, kernels, given);
    }

    /// Solves all threads within rows, likewise.
    pub(super) fn solve_across(
        &mut self,
        blocks: &mut [Block],
        kernels: &Kernels,
        given: Option<&mut Lanes>,
    ) {
        let mut rows = RowThreads {
            blocks,
            is_border: [true; 2],
            scratch: &mut self.rows[0],
            given,
        };
        solve_rows(&mut rows, &self.across, kernels);
    }

    /// The lengths of the springs that begin in these rows.
    fn measure_rows(&self, blocks: &[Block], rows: Range<usize>, kernels: &Kernels) -> Longest {
        let mut longest = Longest::default();
        let strip = self.layout.strip as usize;
        let [across, down, diagonal] = &self.runs;
        for row in rows {
            let (upper, lower) = blocks[row * strip..].split_at(strip);
            (kernels.measure_within)(upper, across, &mut longest);
            if let Some(lower) = lower.get(..strip) {
                (kernels.measure_down)(upper, lower, down, &mut longest);
                if self.diagonal.is_some() {
                    (kernels.measure_diagonal)(upper, lower, diagonal, &mut longest);
                    (kernels.measure_diagonal)(lower, upper, diagonal, &mut longest);
                }
            }
        }
        longest
    }

    fn stretch(&self, longest: &Longest) -> Stretch {
        let ratio = |lanes: &Lanes, run: &Run| {
            (lanes.iter().copied().fold(0.0, f32::max) / run.rest_square).sqrt()
        };
        let structural =
            ratio(&longest.across, &self.runs[0]).max(ratio(&longest.down, &self.runs[1]));
        let bound = structural.max(ratio(&longest.diagonal, &self.runs[2]));
        Stretch::of_ratios(structural, bound)
    }

    /// The stretch of the material, as a fraction of its length, from the squares of the largest elongations of springs
    /// (m²).
    fn material(&self, across: &Lanes, down: &Lanes) -> f32 {
        (largest(across) / self.across[0].rest).max(largest(down) / self.down.rest)
    }

    /// The angular frequency of the fastest ripples (rad/s), in which neighbours swing against each other: ω² = 4 Σ F/(m l) over
    /// a thread across and one down, with tensions F in springs of length l. That of the fourth of the eight strips of columns: a
    /// membrane has it everywhere, and what hangs by a corner is not a membrane.
    fn ripple(&self, blocks: &[Block], across: &Lanes, down: &Lanes) -> f32 {
        let mut strips = [0.0; LANES];
        for (lane, strip) in strips.iter_mut().enumerate() {
            for (given, stiffness) in [across, down].into_iter().zip(self.ripple_stiffness) {
                *strip += given[lane].sqrt() * stiffness;
            }
        }
        strips.sort_by(|a, b| b.total_cmp(a));
        let pull = strips[LANES / 2 - 1];
        if pull == 0.0 {
            return 0.0;
        }
        // Within the cloth, where no pin and no border is.
        let weights = blocks.iter().flat_map(|block| &block.view()[W..W + LANES]);
        let heaviest = weights
            .filter(|weight| **weight > 0.0)
            .fold(f32::INFINITY, |least, weight| least.min(*weight));
        2.0 * (pull * heaviest).sqrt()
    }

    /// A sub-step in this many bands, more than one.
    fn substep_in_bands(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) -> Swept {
        let (kernels, measures) = (motion.kernels, motion.measures);
        if let Some(family) = &self.diagonal {
            for direction in [Direction::Right, Direction::Left] {
                let strip = self.layout.strip as usize;
                let all = self.scratch.split(direction, (strip, bands), blocks);
                in_bands(all, |mut band| solve(&mut band, family, kernels, None));
            }
        }
        let across = self.across_in_bands(blocks, motion, bands);
        let mut found = [Found::default(); MAX_BANDS];
        let (strip, down) = (self.layout.strip as usize, &self.down);
        let all = self.scratch.split(Direction::Down, (strip, bands), blocks);
        in_bands(all.into_iter().zip(&mut found), |(mut band, found)| {
            let given = measures.then_some(&mut found.given);
            solve(&mut band, down, kernels, given);
            for (first, blocks) in band.pieces() {
                let (tethers, anchors) = (motion.tethers, motion.anchors);
                tethers.pull(anchors, blocks, first, kernels);
                (kernels.commit)(blocks, &mut found.moved);
            }
        });
        let rows = self.layout.rows as usize;
        let down = merged(&found, |found| &found.given);
        let stretch = measures.then(|| {
            let border = |band| rows * band / bands;
            let parts = (0..bands).zip(&mut found);
            let blocks = &*blocks;
            in_bands(parts, |(band, found)| {
                let rows = border(band)..border(band + 1);
                found.longest = self.measure_rows(blocks, rows, kernels);
            });
            let mut longest = Longest::default();
            for found in &found[..bands] {
                longest.merge(&found.longest);
            }
            Stretch {
                material: self.material(&across, &down),
                ..self.stretch(&longest)
            }
        });
        Swept {
            moved: merged(&found, |found| &found.moved),
            stretch,
            ripple: self.ripple(blocks, &across, &down),
        }
    }

    /// Solves the threads within rows. Returns the squares of the largest elongations of their springs (m²), if they
    /// are measured.
    fn across_in_bands(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) -> Lanes {
        let strip = self.layout.strip as usize;
        let rows = self.layout.rows as usize;
        let groups = rows.div_ceil(GROUP);
        let border = |band: usize| (groups * band / bands * GROUP).min(rows);
        if self.rows.len() < bands {
            self.rows.resize(bands, RowScratch::new(strip));
        }
        let mut found = [Found::default(); MAX_BANDS];
        let mut rest = blocks;
        let each = self.rows.iter_mut().zip(&mut found).take(bands);
        let parts = each.enumerate().map(|(band, (scratch, found))| RowThreads {
            blocks: take(&mut rest, (border(band + 1) - border(band)) * strip),
            is_border: [band == 0, band + 1 == bands],
            scratch,
            given: motion.measures.then_some(&mut found.given),
        });
        let families = &self.across;
        in_bands(parts, |mut part| {
            solve_rows(&mut part, families, motion.kernels);
        });
        merged(&found, |found| &found.given)
    }
}

impl Sweep for ThreadSweep {
    fn set_pace(&mut self, pace: Pace) {
        if self.pace != pace {
            self.pace = pace;
            for family in self
                .across
                .iter_mut()
                .chain([&mut self.down])
                .chain(&mut self.diagonal)
            {
                family.soften(pace);
            }
        }
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn bands(&self, wanted: usize) -> usize {
        let (strip, rows) = (self.layout.strip as usize, self.layout.rows as usize);
        let most = (rows / MIN_ROWS).min(strip / MIN_BLOCKS);
        wanted.min(most).clamp(1, MAX_BANDS)
    }

    fn substep(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) -> Swept {
        let bands = self.bands(bands);
        if bands > 1 {
            return self.substep_in_bands(blocks, motion, bands);
        }
        let kernels = motion.kernels;
        self.solve_down(blocks, Direction::Right, kernels, None);
        self.solve_down(blocks, Direction::Left, kernels, None);
        let mut given = [0.0; LANES];
        self.solve_across(blocks, kernels, motion.measures.then_some(&mut given));
        let across = given;
        given = [0.0; LANES];
        let measured = motion.measures.then_some(&mut given);
        self.solve_down(blocks, Direction::Down, kernels, measured);
        motion.tethers.pull(motion.anchors, blocks, 0, kernels);
        let mut moved = [0.0; LANES];
        (kernels.commit)(blocks, &mut moved);
        let stretch = motion.measures.then(|| Stretch {
            material: self.material(&across, &given),
            ..self.measure(blocks, kernels)
        });
        Swept {
            moved,
            stretch,
            ripple: self.ripple(blocks, &across, &given),
        }
    }

    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch {
        let rows = 0..self.layout.rows as usize;
        self.stretch(&self.measure_rows(blocks, rows, kernels))
    }

    fn boxed(&self) -> Box<dyn Sweep> {
        Box::new(self.clone())
    }
}

/// Solves threads. Raises `given` to the squares of the elongations of the columns' springs at their tension (m²).
fn solve(threads: &mut Threads, family: &Family, kernels: &Kernels, given: Option<&mut Lanes>) {
    if family.kept < 1.0 {
        (kernels.solve_damped_threads)(threads, family);
    } else {
        (kernels.solve_threads)(threads, family);
    }
    if let Some(given) = given {
        let (links, blocks) = threads.links();
        (kernels.measure_given)(links, &family.softness[blocks], given);
    }
}

/// Solves threads within rows.
fn solve_rows(rows: &mut RowThreads, families: &[Family; 2], kernels: &Kernels) {
    if families[0].kept < 1.0 {
        (kernels.solve_damped_rows)(rows, families);
    } else {
        (kernels.solve_rows)(rows, families);
    }
}

/// The root of the largest of squares.
fn largest(squares: &Lanes) -> f32 {
    squares.iter().copied().fold(0.0, f32::max).sqrt()
}

/// The largest number of each lane.
fn merged(all: &[Found], lanes: impl Fn(&Found) -> &Lanes) -> Lanes {
    let larger = |mut largest: Lanes, found: &Found| {
        for (largest, own) in largest.iter_mut().zip(lanes(found)) {
            *largest = largest.max(*own);
        }
        largest
    };
    all.iter().fold([0.0; LANES], larger)
}
