//! The springs of a grid, thread by thread, in one band or several. A band consists of blocks side by side for threads
//! from row to row, and of rows for threads within rows.

use std::ops::Range;

use super::second_pass::{GridSprings, SecondPass};
use crate::{
    cloth::{Block, ClothGrid, Compliances, LANES, Lanes, Layout, W},
    solver::{
        bands::{MAX_BANDS, in_bands, take},
        kernels::{
            Direction, GROUP, Kernels, Longest, RowScratch, RowThreads, Scratch, SpringBand,
            StepScale, Threads, largest,
        },
        spring_solver::{Motion, SolvedSubstep, SpringSolver},
        stretch::Stretch,
    },
};

/// Fewer rows a band than this, or fewer blocks of a row, and waiting for the others would take longer than the work.
const MIN_ROWS: usize = 32;
const MIN_BLOCKS: usize = 2;

/// The springs of a grid, thread by thread.
#[derive(Debug, Clone)]
pub(crate) struct GridSolver {
    layout: Layout,
    /// Within a row: one on a border, one that is not.
    across: [SpringBand; 2],
    down: SpringBand,
    /// If there are any.
    diagonal: Option<SpringBand>,
    scratch: Scratch,
    /// One for each band.
    rows: Vec<RowScratch>,
    /// The numbers of all rows.
    numbers: Vec<u32>,
    second_pass: SecondPass,
    /// That softnesses hold for.
    step_scale: StepScale,
    /// Largest stiffness over length of springs across and down (N/m²), 0 of those that don't give.
    ripple_stiffness: [f32; 2],
}

/// Results of a band.
#[derive(Default, Clone, Copy)]
struct PartitionResult {
    moved: Lanes,
    longest: Longest,
}

impl GridSolver {
    pub fn new(grid: &ClothGrid, compliances: &Compliances) -> Self {
        let layout = Layout::new(grid.columns(), grid.rows());
        let strip = layout.strip as usize;
        let family = |step, row| SpringBand::new(grid, layout, compliances, step, row);
        let across = [family((0, 1), 0), family((0, 1), 1)];
        let down = family((1, 0), 0);
        let ripple_stiffness =
            [&across[1], &down].map(|family| family.stiffness() * family.inverse_rest);
        let is_elastic = across.iter().chain([&down]).any(SpringBand::is_elastic);
        Self {
            layout,
            second_pass: SecondPass::new(layout, is_elastic),
            numbers: (0..layout.rows).collect(),
            across,
            down,
            ripple_stiffness,
            diagonal: compliances.shear.is_finite().then(|| family((1, 1), 0)),
            scratch: Scratch::new(layout),
            rows: vec![RowScratch::new(strip)],
            step_scale: StepScale::default(),
        }
    }

    /// Solves all threads that lead from row to row in one direction.
    pub(crate) fn solve_down(
        &mut self,
        blocks: &mut [Block],
        direction: Direction,
        kernels: &Kernels,
    ) {
        let Some(family) = (match direction {
            Direction::Down => Some(&self.down),
            Direction::Right | Direction::Residuals => self.diagonal.as_ref(),
        }) else {
            return;
        };
        let strip = self.layout.strip as usize;
        let mut threads = self.scratch.all(direction, strip, blocks);
        solve(&mut threads, family, kernels);
    }

    /// Solves all threads within rows.
    pub(crate) fn solve_across(&mut self, blocks: &mut [Block], kernels: &Kernels) {
        let mut rows = RowThreads {
            blocks,
            first: 0,
            of: self.numbers.len(),
            numbers: &self.numbers,
            scratch: &mut self.rows[0],
            pulled: &mut self.second_pass.pulled[0],
        };
        solve_rows(&mut rows, &self.across, kernels);
    }

    /// What solves again what is left in rows and columns, after all threads were solved in this many bands.
    pub(crate) fn second_pass(&mut self, bands: usize) -> (&mut SecondPass, GridSprings<'_>) {
        let strip = self.layout.strip as usize;
        if let Some(pulled) = self.second_pass.pulled[1].get_mut(strip..) {
            self.scratch.multipliers(strip, bands, pulled);
        }
        let grid = GridSprings {
            across: &self.across,
            down: &self.down,
            rows: &mut self.rows[0],
            columns: &mut self.scratch,
        };
        (&mut self.second_pass, grid)
    }

    fn solve_again(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) {
        let (second_pass, mut grid) = self.second_pass(bands);
        second_pass.solve(blocks, &mut grid, motion, bands);
    }

    /// The lengths of the springs that begin in these rows.
    fn measure_rows(&self, blocks: &[Block], rows: Range<usize>, kernels: &Kernels) -> Longest {
        let mut longest = Longest::default();
        let strip = self.layout.strip as usize;
        let [across, _] = &self.across;
        for row in rows {
            let (upper, lower) = blocks[row * strip..].split_at(strip);
            (kernels.measure_within)(upper, across, &mut longest);
            if let Some(lower) = lower.get(..strip) {
                (kernels.measure_down)(upper, lower, &self.down, &mut longest);
                if let Some(diagonal) = &self.diagonal {
                    (kernels.measure_diagonal)(upper, lower, diagonal, &mut longest);
                    (kernels.measure_diagonal)(lower, upper, diagonal, &mut longest);
                }
            }
        }
        longest
    }

    fn stretch(&self, longest: &Longest) -> Stretch {
        let ratio = |lanes: &Lanes, springs: &SpringBand| {
            lanes.iter().copied().fold(0.0, f32::max).sqrt() * springs.inverse_rest
        };
        let structural =
            ratio(&longest.across, &self.across[0]).max(ratio(&longest.down, &self.down));
        let diagonal = self.diagonal.iter();
        let diagonal = diagonal.map(|springs| ratio(&longest.diagonal, springs));
        let bound = diagonal.fold(structural, f32::max);
        Stretch::of_ratios(structural, bound)
    }

    /// The stretch of the material, as a fraction of its length, from the elongations of springs (m).
    fn material(&self, [across, down]: &[Lanes; 2]) -> f32 {
        (largest(*across) / self.across[0].rest).max(largest(*down) / self.down.rest)
    }

    /// The angular frequency of the fastest ripples (rad/s), in which neighbours swing against each other: ω² = 4 Σ F/(m l) over
    /// a thread across and one down, with tensions F in springs of length l. That of the fourth of the eight strips of columns: a
    /// membrane has it everywhere, and what hangs by a corner is not a membrane.
    fn ripple(&self, blocks: &[Block], given: &[Lanes; 2]) -> f32 {
        let mut strips = [0.0; LANES];
        for (lane, strip) in strips.iter_mut().enumerate() {
            for (given, stiffness) in given.iter().zip(self.ripple_stiffness) {
                *strip += given[lane] * stiffness;
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

    /// Solves all threads in this many bands, more than one.
    fn solve_in_bands(&mut self, blocks: &mut [Block], kernels: &Kernels, bands: usize) {
        let strip = self.layout.strip as usize;
        if let Some(family) = &self.diagonal {
            for direction in [Direction::Right, Direction::Residuals] {
                let all = self.scratch.split(direction, (strip, bands), blocks);
                in_bands(all, |mut band| solve(&mut band, family, kernels));
            }
        }
        self.across_in_bands(blocks, kernels, bands);
        let down = &self.down;
        let all = self.scratch.split(Direction::Down, (strip, bands), blocks);
        in_bands(all, |mut band| solve(&mut band, down, kernels));
    }

    /// Ends a sub-step in this many bands.
    fn end_in_bands(&self, blocks: &mut [Block], motion: &Motion, bands: usize) -> SolvedSubstep {
        let (kernels, measures) = (motion.kernels, motion.measures);
        let (strip, rows) = (self.layout.strip as usize, self.layout.rows as usize);
        let border = |band| rows * band / bands;
        let mut found = [PartitionResult::default(); MAX_BANDS];
        let mut rest = &mut *blocks;
        let parts = found
            .iter_mut()
            .take(bands)
            .enumerate()
            .map(|(band, found)| {
                let size = (border(band + 1) - border(band)) * strip;
                (border(band) * strip, take(&mut rest, size), found)
            });
        in_bands(parts, |(first, blocks, found)| {
            let (tethers, anchors) = (motion.tethers, motion.anchors);
            tethers.pull(anchors, blocks, first, kernels);
            (kernels.commit)(blocks, &mut found.moved);
        });
        let given = self.given_if(measures, kernels);
        let stretch = measures.then(|| {
            let blocks = &*blocks;
            in_bands((0..bands).zip(&mut found), |(band, found)| {
                let rows = border(band)..border(band + 1);
                found.longest = self.measure_rows(blocks, rows, kernels);
            });
            let mut longest = Longest::default();
            for found in &found[..bands] {
                longest.merge(&found.longest);
            }
            Stretch {
                material: self.material(&given),
                ..self.stretch(&longest)
            }
        });
        SolvedSubstep {
            moved: farthest(&found),
            stretch,
            ripple: self.ripple(blocks, &given),
        }
    }

    /// The elongations of elastic springs across and down (m), if they are measured.
    fn given_if(&self, measures: bool, kernels: &Kernels) -> [Lanes; 2] {
        if measures {
            self.second_pass.given(&self.across, &self.down, kernels)
        } else {
            [[0.0; LANES]; 2]
        }
    }

    /// Solves the threads within rows.
    fn across_in_bands(&mut self, blocks: &mut [Block], kernels: &Kernels, bands: usize) {
        let strip = self.layout.strip as usize;
        let rows = self.layout.rows as usize;
        let groups = rows.div_ceil(GROUP);
        let border = |band: usize| (groups * band / bands * GROUP).min(rows);
        if self.rows.len() < bands {
            self.rows.resize(bands, RowScratch::new(strip));
        }
        let (mut rest, mut pulled) = (blocks, &mut self.second_pass.pulled[0][..]);
        let is_elastic = !pulled.is_empty();
        let each = self.rows.iter_mut().take(bands).enumerate();
        let parts = each.map(|(band, scratch)| {
            let size = (border(band + 1) - border(band)) * strip;
            RowThreads {
                blocks: take(&mut rest, size),
                first: border(band),
                of: rows,
                numbers: &self.numbers[border(band)..border(band + 1)],
                scratch,
                pulled: take(&mut pulled, if is_elastic { size } else { 0 }),
            }
        });
        let families = &self.across;
        in_bands(parts, |mut part| solve_rows(&mut part, families, kernels));
    }
}

impl SpringSolver for GridSolver {
    fn set_step_scale(&mut self, step_scale: StepScale) {
        if self.step_scale != step_scale {
            self.step_scale = step_scale;
            for family in self
                .across
                .iter_mut()
                .chain([&mut self.down])
                .chain(&mut self.diagonal)
            {
                family.soften(step_scale);
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

    fn substep(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) -> SolvedSubstep {
        let bands = self.bands(bands);
        let kernels = motion.kernels;
        if bands > 1 {
            self.solve_in_bands(blocks, kernels, bands);
            self.solve_again(blocks, motion, bands);
            return self.end_in_bands(blocks, motion, bands);
        }
        self.solve_down(blocks, Direction::Right, kernels);
        self.solve_down(blocks, Direction::Residuals, kernels);
        self.solve_across(blocks, kernels);
        self.solve_down(blocks, Direction::Down, kernels);
        self.solve_again(blocks, motion, 1);
        motion.tethers.pull(motion.anchors, blocks, 0, kernels);
        let mut moved = [0.0; LANES];
        (kernels.commit)(blocks, &mut moved);
        let given = self.given_if(motion.measures, kernels);
        let stretch = motion.measures.then(|| Stretch {
            material: self.material(&given),
            ..self.measure(blocks, kernels)
        });
        SolvedSubstep {
            moved,
            stretch,
            ripple: self.ripple(blocks, &given),
        }
    }

    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch {
        let rows = 0..self.layout.rows as usize;
        self.stretch(&self.measure_rows(blocks, rows, kernels))
    }

    fn boxed(&self) -> Box<dyn SpringSolver> {
        Box::new(self.clone())
    }
}

/// Solves threads.
fn solve(threads: &mut Threads, family: &SpringBand, kernels: &Kernels) {
    if family.kept < 1.0 {
        (kernels.solve_damped_threads)(threads, family);
    } else {
        (kernels.solve_threads)(threads, family);
    }
}

/// Solves threads within rows.
fn solve_rows(rows: &mut RowThreads, families: &[SpringBand; 2], kernels: &Kernels) {
    if families[0].kept < 1.0 {
        (kernels.solve_damped_rows)(rows, families);
    } else {
        (kernels.solve_rows)(rows, families);
    }
}

/// The largest squared displacements of all bands (m²), lane by lane.
fn farthest(all: &[PartitionResult]) -> Lanes {
    let larger = |mut farthest: Lanes, found: &PartitionResult| {
        for (farthest, own) in farthest.iter_mut().zip(&found.moved) {
            *farthest = farthest.max(*own);
        }
        farthest
    };
    all.iter().fold([0.0; LANES], larger)
}
