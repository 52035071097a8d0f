//! The springs of a grid, chain by chain, in one partition or several. A partition consists of blocks side by side for chains
//! from row to row, and of rows for chains within rows.

use super::{
    bands::GridBands,
    second_pass::{GridSprings, SecondPass},
};
use crate::{
    cloth::{Block, ClothGrid, Compliances, LANES, Lanes, Layout, SpringList, W},
    solver::{
        kernels::{
            Chains, Direction, GROUP, Kernels, Longest, RowChains, RowScratch, Scratch, SpringBand,
            StepScale,
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
    bands: GridBands,
    scratch: Scratch,
    /// One for each partition.
    rows: Vec<RowScratch>,
    /// The numbers of all rows.
    numbers: Vec<u32>,
    second_pass: SecondPass,
    /// That softnesses hold for.
    step_scale: StepScale,
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
        Self::of_bands(layout, GridBands::new(grid, layout, compliances))
    }

    /// Of those of the springs in a list that join neighbours of the grid: of a torn or mapped one.
    pub fn of_list(grid: &ClothGrid, list: &SpringList) -> Self {
        let layout = Layout::new(grid.columns(), grid.rows());
        Self::of_bands(layout, GridBands::of_list(grid, layout, list))
    }

    fn of_bands(layout: Layout, bands: GridBands) -> Self {
        Self {
            layout,
            second_pass: SecondPass::new(layout, bands.is_elastic()),
            numbers: (0..layout.rows).collect(),
            bands,
            scratch: Scratch::new(layout),
            rows: vec![RowScratch::new(layout.strip as usize)],
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
        let Some(springs) = self.bands.of(direction) else {
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
        solve_rows(&mut rows, &self.bands.across, kernels);
    }

    /// The second pass over rows and columns, after all chains were solved in this many partitions.
    pub(crate) fn second_pass(&mut self, partitions: usize) -> (&mut SecondPass, GridSprings<'_>) {
        let strip = self.layout.strip as usize;
        if let Some(pulled) = self.second_pass.pulled[1].get_mut(strip..) {
            self.scratch.multipliers(strip, partitions, pulled);
        }
        let grid = GridSprings {
            across: &self.bands.across,
            down: &self.bands.down,
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

    /// The angular frequency of the fastest ripples (rad/s), in which neighbours swing against each other: ω² = 4 Σ F/(m l) over
    /// a chain across and one down, with tensions F in springs of length l. That of the fourth of the eight strips of columns: a
    /// membrane has it everywhere, and what hangs by a corner is not a membrane. 0 if nothing is measured.
    fn ripple_if(&self, measures: bool, blocks: &[Block], given: &[Lanes; 2]) -> f32 {
        if !measures {
            return 0.0;
        }
        let mut strips = if self.bands.is_by_row() {
            // Where springs differ, the longest need not pull most.
            self.bands
                .tensions(&self.second_pass.pulled, self.step_scale)
        } else {
            self.bands.tensions_of(given)
        };
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

    /// Solves the chains along diagonals, in this many partitions.
    pub(crate) fn solve_diagonals(
        &mut self,
        blocks: &mut [Block],
        kernels: &Kernels,
        partitions: usize,
    ) {
        for direction in [Direction::Right, Direction::Left] {
            self.down_in_partitions(blocks, direction, kernels, partitions);
        }
    }

    /// Solves rows, and then columns, in this many partitions.
    pub(crate) fn solve_along(
        &mut self,
        blocks: &mut [Block],
        kernels: &Kernels,
        partitions: usize,
    ) {
        if partitions > 1 {
            self.across_in_partitions(blocks, kernels, partitions);
        } else {
            self.solve_across(blocks, kernels);
        }
        self.down_in_partitions(blocks, Direction::Down, kernels, partitions);
    }

    fn down_in_partitions(
        &mut self,
        blocks: &mut [Block],
        direction: Direction,
        kernels: &Kernels,
        partitions: usize,
    ) {
        if partitions == 1 {
            self.solve_down(blocks, direction, kernels);
        } else if let Some(springs) = self.bands.of(direction) {
            let strip = self.layout.strip as usize;
            let all = self.scratch.split(direction, (strip, partitions), blocks);
            in_partitions(all, |mut partition| solve(&mut partition, springs, kernels));
        }
    }

    /// Ends a sub-step in this many partitions. Behind the grid's blocks there may be others.
    pub(crate) fn end(
        &self,
        blocks: &mut [Block],
        motion: &Motion,
        partitions: usize,
    ) -> SolvedSubstep {
        if partitions > 1 {
            return self.end_in_partitions(blocks, motion, partitions);
        }
        let (kernels, measures) = (motion.kernels, motion.measures);
        motion.tethers.pull(motion.anchors, blocks, 0, kernels);
        let mut moved = [0.0; LANES];
        (kernels.commit)(blocks, &mut moved);
        let given = self.given_if(measures, kernels);
        let stretch = measures.then(|| Stretch {
            material: self.bands.material(&given),
            ..self.measure(blocks, kernels)
        });
        SolvedSubstep {
            moved,
            stretch,
            ripple: self.ripple_if(measures, blocks, &given),
        }
    }

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
                let size = match partition + 1 == partitions {
                    true => rest.len(),
                    false => (border(partition + 1) - border(partition)) * strip,
                };
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
                found.longest = self.bands.measure_rows(blocks, self.layout, rows, kernels);
            });
            let mut longest = Longest::default();
            for found in &found[..partitions] {
                longest.merge(&found.longest);
            }
            Stretch {
                material: self.bands.material(&given),
                ..self.bands.stretch(&longest)
            }
        });
        SolvedSubstep {
            moved: farthest(&found),
            stretch,
            ripple: self.ripple_if(measures, blocks, &given),
        }
    }

    /// The elongations of elastic springs across and down (m), if they are measured.
    fn given_if(&self, measures: bool, kernels: &Kernels) -> [Lanes; 2] {
        if measures {
            self.second_pass
                .given(&self.bands.across, &self.bands.down, kernels)
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
        let springs = &self.bands.across;
        in_partitions(parts, |mut part| solve_rows(&mut part, springs, kernels));
    }
}

impl SpringSolver for GridSolver {
    fn set_step_scale(&mut self, step_scale: StepScale) {
        if self.step_scale != step_scale {
            self.step_scale = step_scale;
            self.bands.soften(step_scale);
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
        self.solve_diagonals(blocks, motion.kernels, partitions);
        self.solve_along(blocks, motion.kernels, partitions);
        self.solve_again(blocks, motion, partitions);
        self.end(blocks, motion, partitions)
    }

    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch {
        let rows = 0..self.layout.rows as usize;
        self.bands
            .stretch(&self.bands.measure_rows(blocks, self.layout, rows, kernels))
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
