//! The springs of a grid, chain by chain, in one partition or several. A partition consists of blocks side by side for chains
//! from row to row, and of rows for chains within rows.

use std::ops::Range;

use super::second_pass::{GridSprings, SecondPass};
use crate::{
    cloth::{Block, ClothGrid, Compliances, LANES, Lanes, Layout, SpringList, W},
    solver::{
        kernels::{
            Chains, Direction, GROUP, Kernels, Longest, RowChains, RowScratch, Scratch, SpringBand,
            StepScale, largest,
        },
        partitions::{MAX_PARTITIONS, in_partitions, take},
        spring_solver::{Motion, SolvedSubstep, SpringSolver},
        stretch::Stretch,
    },
};

/// Fewer rows a partition than this, or fewer blocks of a row, and waiting for the others would take longer than the work.
const MIN_ROWS: usize = 32;
const MIN_BLOCKS: usize = 2;

/// The springs of a grid, chain by chain.
#[derive(Debug, Clone)]
pub(crate) struct GridSolver {
    layout: Layout,
    /// Within a row: one on a border, one that is not.
    across: [SpringBand; 2],
    down: SpringBand,
    /// To the right and to the left, if there are any.
    diagonals: Option<[SpringBand; 2]>,
    scratch: Scratch,
    /// One for each partition.
    rows: Vec<RowScratch>,
    /// The numbers of all rows.
    numbers: Vec<u32>,
    second_pass: SecondPass,
    /// That softnesses hold for.
    step_scale: StepScale,
    /// Largest stiffness over length of springs across and down (N/m²), 0 of those that don't give.
    ripple_stiffness: [f32; 2],
}

/// Results of a partition.
#[derive(Default, Clone, Copy)]
struct PartitionResult {
    moved: Lanes,
    longest: Longest,
}

impl GridSolver {
    pub fn new(grid: &ClothGrid, compliances: &Compliances) -> Self {
        let layout = Layout::new(grid.columns(), grid.rows());
        let springs = |step, row| SpringBand::new(grid, layout, compliances, step, row);
        let across = [springs((0, 1), 0), springs((0, 1), 1)];
        let diagonal = || springs((1, 1), 0);
        let diagonals = compliances
            .shear
            .is_finite()
            .then(|| [(); 2].map(|()| diagonal()));
        Self::of_bands(layout, across, springs((1, 0), 0), diagonals)
    }

    /// Of those of the springs in a list that join neighbours of the grid: of a torn or mapped one.
    pub fn of_list(grid: &ClothGrid, list: &SpringList) -> Self {
        let (columns, rows) = (grid.columns() as usize, grid.rows() as usize);
        let layout = Layout::new(grid.columns(), grid.rows());
        let on_grid = list.on_grid(grid);
        let band = |step, of: &[f32], direction: Direction| {
            SpringBand::of_rows(grid.step_length(step), layout, rows, |number, column| {
                let row = direction.row(number, rows);
                let compliance = of[row * columns + column as usize];
                (!compliance.is_nan()).then_some(compliance)
            })
        };
        let across = [(); 2].map(|()| band((0, 1), &on_grid.across, Direction::Down));
        let down = band((1, 0), &on_grid.down, Direction::Down);
        let (falling, rising) = (&on_grid.falling, &on_grid.rising);
        let has_diagonals = falling.iter().chain(rising).any(|of| !of.is_nan());
        let diagonals = has_diagonals.then(|| {
            [(falling, Direction::Right), (rising, Direction::Left)]
                .map(|(of, direction)| band((1, 1), of, direction))
        });
        Self::of_bands(layout, across, down, diagonals)
    }

    fn of_bands(
        layout: Layout,
        across: [SpringBand; 2],
        down: SpringBand,
        diagonals: Option<[SpringBand; 2]>,
    ) -> Self {
        let strip = layout.strip as usize;
        let ripple_stiffness =
            [&across[1], &down].map(|springs| springs.stiffness() * springs.inverse_rest);
        let is_elastic = across.iter().chain([&down]).any(SpringBand::is_elastic);
        Self {
            layout,
            second_pass: SecondPass::new(layout, is_elastic),
            numbers: (0..layout.rows).collect(),
            across,
            down,
            ripple_stiffness,
            diagonals,
            scratch: Scratch::new(layout),
            rows: vec![RowScratch::new(strip)],
            step_scale: StepScale::default(),
        }
    }

    /// Blocks of the grid's particles: the first.
    pub(crate) fn blocks(&self) -> usize {
        self.layout.blocks()
    }

    /// Solves all chains that lead from row to row in one direction.
    pub(crate) fn solve_down(
        &mut self,
        blocks: &mut [Block],
        direction: Direction,
        kernels: &Kernels,
    ) {
        let [right, left] = match &self.diagonals {
            Some([right, left]) => [Some(right), Some(left)],
            None => [None; 2],
        };
        let Some(springs) = (match direction {
            Direction::Down => Some(&self.down),
            Direction::Right => right,
            Direction::Left => left,
        }) else {
            return;
        };
        let strip = self.layout.strip as usize;
        let mut chains = self.scratch.all(direction, strip, blocks);
        solve(&mut chains, springs, kernels);
    }

    /// Solves all chains within rows.
    pub(crate) fn solve_across(&mut self, blocks: &mut [Block], kernels: &Kernels) {
        let mut rows = RowChains {
            blocks,
            first: 0,
            of: self.numbers.len(),
            numbers: &self.numbers,
            scratch: &mut self.rows[0],
            pulled: &mut self.second_pass.pulled[0],
        };
        solve_rows(&mut rows, &self.across, kernels);
    }

    /// The second pass over rows and columns, after all chains were solved in this many partitions.
    pub(crate) fn second_pass(&mut self, partitions: usize) -> (&mut SecondPass, GridSprings<'_>) {
        let strip = self.layout.strip as usize;
        if let Some(pulled) = self.second_pass.pulled[1].get_mut(strip..) {
            self.scratch.multipliers(strip, partitions, pulled);
        }
        let grid = GridSprings {
            across: &self.across,
            down: &self.down,
            rows: &mut self.rows[0],
            columns: &mut self.scratch,
        };
        (&mut self.second_pass, grid)
    }

    /// The second pass, after all chains were solved in this many partitions.
    pub(crate) fn solve_again(&mut self, blocks: &mut [Block], motion: &Motion, partitions: usize) {
        let (second_pass, mut grid) = self.second_pass(partitions);
        second_pass.solve(blocks, &mut grid, motion, partitions);
    }

    /// The lengths of the springs that begin in these rows.
    fn measure_rows(&self, blocks: &[Block], rows: Range<usize>, kernels: &Kernels) -> Longest {
        let mut longest = Longest::default();
        let strip = self.layout.strip as usize;
        let [across, _] = &self.across;
        let last = self.layout.rows as usize - 1;
        for row in rows {
            let (upper, lower) = blocks[row * strip..].split_at(strip);
            (kernels.measure_within)(upper, across.holds_of(row, strip), &mut longest);
            if row < last {
                let lower = &lower[..strip];
                (kernels.measure_down)(upper, lower, self.down.holds_of(row, strip), &mut longest);
                if let Some([right, left]) = &self.diagonals {
                    let left = left.holds_of(Direction::Left.row(row + 1, last + 1), strip);
                    (kernels.measure_diagonal)(
                        upper,
                        lower,
                        right.holds_of(row, strip),
                        &mut longest,
                    );
                    (kernels.measure_diagonal)(lower, upper, left, &mut longest);
                }
            }
        }
        longest
    }

    fn stretch(&self, longest: &Longest) -> Stretch {
        let ratio = |lanes: &Lanes, springs: &SpringBand| {
            (lanes.iter().copied().fold(0.0, f32::max) / (springs.rest * springs.rest)).sqrt()
        };
        let structural =
            ratio(&longest.across, &self.across[0]).max(ratio(&longest.down, &self.down));
        let diagonal = self.diagonals.iter();
        let diagonal = diagonal.map(|[springs, _]| ratio(&longest.diagonal, springs));
        let bound = diagonal.fold(structural, f32::max);
        Stretch::of_ratios(structural, bound)
    }

    /// The stretch of the material, as a fraction of its length, from the elongations of springs (m).
    fn material(&self, [across, down]: &[Lanes; 2]) -> f32 {
        (largest(*across) / self.across[0].rest).max(largest(*down) / self.down.rest)
    }

    /// The angular frequency of the fastest ripples (rad/s), in which neighbours swing against each other: ω² = 4 Σ F/(m l) over
    /// a chain across and one down, with tensions F in springs of length l. That of the fourth of the eight strips of columns: a
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

    /// Solves all chains in this many partitions, more than one.
    fn solve_in_partitions(&mut self, blocks: &mut [Block], kernels: &Kernels, partitions: usize) {
        let strip = self.layout.strip as usize;
        if let Some([right, left]) = &self.diagonals {
            for (direction, springs) in [(Direction::Right, right), (Direction::Left, left)] {
                let all = self.scratch.split(direction, (strip, partitions), blocks);
                in_partitions(all, |mut partition| solve(&mut partition, springs, kernels));
            }
        }
        self.across_in_partitions(blocks, kernels, partitions);
        let down = &self.down;
        let all = self
            .scratch
            .split(Direction::Down, (strip, partitions), blocks);
        in_partitions(all, |mut partition| solve(&mut partition, down, kernels));
    }

    /// Ends a sub-step. Behind the grid's blocks there may be others.
    pub(crate) fn end(&self, blocks: &mut [Block], motion: &Motion) -> SolvedSubstep {
        let kernels = motion.kernels;
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

    /// Ends a sub-step in this many partitions.
    fn end_in_partitions(
        &self,
        blocks: &mut [Block],
        motion: &Motion,
        partitions: usize,
    ) -> SolvedSubstep {
        let (kernels, measures) = (motion.kernels, motion.measures);
        let (strip, rows) = (self.layout.strip as usize, self.layout.rows as usize);
        let border = |partition| rows * partition / partitions;
        let mut found = [PartitionResult::default(); MAX_PARTITIONS];
        let mut rest = &mut *blocks;
        let parts = found
            .iter_mut()
            .take(partitions)
            .enumerate()
            .map(|(partition, found)| {
                let size = (border(partition + 1) - border(partition)) * strip;
                (border(partition) * strip, take(&mut rest, size), found)
            });
        in_partitions(parts, |(first, blocks, found)| {
            let (tethers, anchors) = (motion.tethers, motion.anchors);
            tethers.pull(anchors, blocks, first, kernels);
            (kernels.commit)(blocks, &mut found.moved);
        });
        let given = self.given_if(measures, kernels);
        let stretch = measures.then(|| {
            let blocks = &*blocks;
            in_partitions((0..partitions).zip(&mut found), |(partition, found)| {
                let rows = border(partition)..border(partition + 1);
                found.longest = self.measure_rows(blocks, rows, kernels);
            });
            let mut longest = Longest::default();
            for found in &found[..partitions] {
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

    /// Solves the chains within rows.
    fn across_in_partitions(&mut self, blocks: &mut [Block], kernels: &Kernels, partitions: usize) {
        let strip = self.layout.strip as usize;
        let rows = self.layout.rows as usize;
        let groups = rows.div_ceil(GROUP);
        let border = |partition: usize| (groups * partition / partitions * GROUP).min(rows);
        if self.rows.len() < partitions {
            self.rows.resize(partitions, RowScratch::new(strip));
        }
        let (mut rest, mut pulled) = (blocks, &mut self.second_pass.pulled[0][..]);
        let is_elastic = !pulled.is_empty();
        let each = self.rows.iter_mut().take(partitions).enumerate();
        let parts = each.map(|(partition, scratch)| {
            let size = (border(partition + 1) - border(partition)) * strip;
            RowChains {
                blocks: take(&mut rest, size),
                first: border(partition),
                of: rows,
                numbers: &self.numbers[border(partition)..border(partition + 1)],
                scratch,
                pulled: take(&mut pulled, if is_elastic { size } else { 0 }),
            }
        });
        let springs = &self.across;
        in_partitions(parts, |mut part| solve_rows(&mut part, springs, kernels));
    }
}

impl SpringSolver for GridSolver {
    fn set_step_scale(&mut self, step_scale: StepScale) {
        if self.step_scale != step_scale {
            self.step_scale = step_scale;
            for springs in self
                .across
                .iter_mut()
                .chain([&mut self.down])
                .chain(self.diagonals.iter_mut().flatten())
            {
                springs.soften(step_scale);
            }
        }
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn partitions(&self, wanted: usize) -> usize {
        let (strip, rows) = (self.layout.strip as usize, self.layout.rows as usize);
        let most = (rows / MIN_ROWS).min(strip / MIN_BLOCKS);
        wanted.min(most).clamp(1, MAX_PARTITIONS)
    }

    fn substep(
        &mut self,
        blocks: &mut [Block],
        motion: &Motion,
        partitions: usize,
    ) -> SolvedSubstep {
        let partitions = self.partitions(partitions);
        let kernels = motion.kernels;
        if partitions > 1 {
            self.solve_in_partitions(blocks, kernels, partitions);
            self.solve_again(blocks, motion, partitions);
            return self.end_in_partitions(blocks, motion, partitions);
        }
        self.solve_down(blocks, Direction::Right, kernels);
        self.solve_down(blocks, Direction::Left, kernels);
        self.solve_across(blocks, kernels);
        self.solve_down(blocks, Direction::Down, kernels);
        self.solve_again(blocks, motion, 1);
        self.end(blocks, motion)
    }

    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch {
        let rows = 0..self.layout.rows as usize;
        self.stretch(&self.measure_rows(blocks, rows, kernels))
    }

    fn boxed(&self) -> Box<dyn SpringSolver> {
        Box::new(self.clone())
    }
}

/// Solves chains.
fn solve(chains: &mut Chains, springs: &SpringBand, kernels: &Kernels) {
    if springs.kept < 1.0 {
        (kernels.solve_damped_chains)(chains, springs);
    } else {
        (kernels.solve_chains)(chains, springs);
    }
}

/// Solves chains within rows.
fn solve_rows(rows: &mut RowChains, springs: &[SpringBand; 2], kernels: &Kernels) {
    if springs[0].kept < 1.0 {
        (kernels.solve_damped_rows)(rows, springs);
    } else {
        (kernels.solve_rows)(rows, springs);
    }
}

/// The largest squared displacements of all partitions (m²), lane by lane.
fn farthest(all: &[PartitionResult]) -> Lanes {
    let larger = |mut farthest: Lanes, found: &PartitionResult| {
        for (farthest, own) in farthest.iter_mut().zip(&found.moved) {
            *farthest = farthest.max(*own);
        }
        farthest
    };
    all.iter().fold([0.0; LANES], larger)
}
