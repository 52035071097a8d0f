//! Rows and columns that are solved again, where those solved after them have left something.
//!
//! Each chain is solved exactly, but the next ones move its particles again. That is little, except where one chain carries
//! many others, as beside a pin that a cloth hangs by: there it adds up from sub-step to sub-step. So after the pass, what is
//! left in each row and column is measured, and those in which it is too much are solved again. Their crossing chains are
//! measured then, and so on, for a few rounds. It is the iteration of Gauss and Seidel by chains (Saad 2003, section 4.1),
//! for those equations alone that need it.

use crate::{
    cloth::{Block, LANES, Lanes, Layout},
    solver::{
        kernels::{
            Columns, Kernels, Residuals, RowChains, RowScratch, RowSprings, Scratch, SpringBand,
            largest,
        },
        partitions::{in_partitions, take},
        spring_solver::Motion,
    },
};

/// The largest squared length of a spring of a row or column that is left, over that which it should have: half a per cent of
/// stretch.
const LIMIT: f32 = 1.005 * 1.005;

/// With a quarter of that everywhere, this sub-step and the next three together leave no more than the limit, and those are
/// not looked at. In a tick in which something was solved again, all are: to do so now and then drives the cloth.
const CALM: f32 = 1.00125 * 1.00125;
const CALM_SUBSTEPS: u32 = 3;

/// Rounds at most. More are hardly ever needed, except by a chain between pins too far apart, which none would help.
const ROUNDS: usize = 4;

/// The part of a spring's length that its pull has given, at most.
const MOST_GIVEN: f32 = 0.9;

/// The stretch that is left in chains side by side.
#[derive(Debug, Clone)]
struct Chains {
    left: Vec<f32>,
    /// Those that are solved again.
    chosen: Vec<u32>,
}

impl Chains {
    fn new(count: usize) -> Self {
        Self {
            left: vec![0.0; count],
            chosen: Vec::with_capacity(count),
        }
    }

    /// Chooses those that are solved again. Returns whether there are any.
    fn choose(&mut self) -> bool {
        self.chosen.clear();
        let beyond = self.left.iter().enumerate();
        let beyond = beyond.filter(|(_, left)| **left > LIMIT);
        self.chosen.extend(beyond.map(|(number, _)| number as u32));
        !self.chosen.is_empty()
    }

    fn largest(&self) -> f32 {
        self.left.iter().copied().fold(0.0, f32::max)
    }
}

/// The springs of a grid's rows and columns, and memory to solve them in.
pub(crate) struct GridSprings<'a> {
    /// Within a row: one on a border, one that is not.
    pub across: &'a [SpringBand; 2],
    pub down: &'a SpringBand,
    pub rows: &'a mut RowScratch,
    pub columns: &'a mut Scratch,
}

/// Finds what is left, and solves it.
#[derive(Debug, Clone)]
pub(crate) struct SecondPass {
    strip: usize,
    rows: Chains,
    /// Of each block of a row: its columns.
    columns: Chains,
    /// One for each partition.
    found: Vec<Residuals>,
    /// Multipliers of the springs within each row, and of those that lead to it from the row above (m kg). Empty where all
    /// are rigid.
    pub pulled: [Vec<Lanes>; 2],
    /// Sub-steps that are not looked at.
    calm: u32,
    /// Whether something was solved again in this tick.
    is_busy: bool,
}

impl SecondPass {
    pub fn new(layout: Layout, is_elastic: bool) -> Self {
        let (strip, rows) = (layout.strip as usize, layout.rows as usize);
        let multipliers = if is_elastic { layout.blocks() } else { 0 };
        Self {
            strip,
            rows: Chains::new(rows),
            columns: Chains::new(strip),
            found: vec![Residuals::new(strip)],
            pulled: [(); 2].map(|()| vec![[0.0; LANES]; multipliers]),
            calm: 0,
            is_busy: false,
        }
    }

    /// Solves again what is left after a pass over all chains.
    pub fn solve(
        &mut self,
        blocks: &mut [Block],
        grid: &mut GridSprings,
        motion: &Motion,
        partitions: usize,
    ) {
        // Damping holds against a stretch that it has not let in: that is not left over.
        if grid.down.kept < 1.0 {
            return;
        }
        self.is_busy &= !motion.begins;
        let is_watched = motion.begins || motion.measures;
        if self.calm > 0 && !is_watched {
            self.calm -= 1;
            return;
        }
        let kernels = motion.kernels;
        self.measure(blocks, grid, kernels, partitions);
        let most = self.rows.largest().max(self.columns.largest());
        let is_calm = most < CALM && !self.is_busy;
        self.calm = if is_calm { CALM_SUBSTEPS } else { 0 };
        if most <= LIMIT {
            return;
        }
        self.is_busy = true;
        for _ in 0..ROUNDS {
            let some_rows = self.rows.choose();
            if some_rows {
                self.solve_rows(blocks, grid, kernels);
            }
            if self.columns.choose() {
                self.solve_columns(blocks, grid, kernels);
            } else if !some_rows {
                return;
            }
        }
    }

    /// Elongations at their tension (m) of the springs across and down that give, as parts of lengths without it, lane by
    /// lane.
    pub fn given(
        &self,
        across: &[SpringBand; 2],
        down: &SpringBand,
        kernels: &Kernels,
    ) -> [Lanes; 2] {
        let mut given = [[0.0; LANES]; 2];
        let [border, inner] = across;
        let [in_rows, from_above] = &self.pulled;
        let last = self.rows.left.len() - 1;
        for (row, pulled) in in_rows.chunks_exact(self.strip).enumerate() {
            let is_border = row == 0 || row == last;
            let springs = if is_border { border } else { inner };
            let softness = &springs.softness[springs.first_of(row)..];
            (kernels.measure_given)(pulled, softness, &mut given[0]);
        }
        for (row, pulled) in from_above.chunks_exact(self.strip).skip(1).enumerate() {
            let softness = &down.softness[down.first_of(row)..];
            (kernels.measure_given)(pulled, softness, &mut given[1]);
        }
        let bands = [inner, down];
        for (given, springs) in given.iter_mut().zip(bands) {
            // At a length l of which the part g/r is given, the pull has given g l/r.
            *given = given.map(|given| {
                let part = (given * springs.inverse_rest).min(MOST_GIVEN);
                given / (1.0 - part)
            });
        }
        given
    }

    /// Solves all rows or all columns again.
    #[cfg(test)]
    pub fn solve_all(&mut self, blocks: &mut [Block], grid: &mut GridSprings, down: bool) {
        let kernels = crate::solver::kernels::SimdLevel::Auto.kernels();
        let chains = if down {
            &mut self.columns
        } else {
            &mut self.rows
        };
        chains.left.fill(f32::INFINITY);
        chains.choose();
        if down {
            self.solve_columns(blocks, grid, &kernels);
        } else {
            self.solve_rows(blocks, grid, &kernels);
        }
    }

    /// Measures all rows and columns.
    fn measure(
        &mut self,
        blocks: &[Block],
        grid: &GridSprings,
        kernels: &Kernels,
        partitions: usize,
    ) {
        let (strip, count) = (self.strip, self.rows.left.len());
        if self.found.len() < partitions {
            self.found.resize(partitions, Residuals::new(strip));
        }
        let border = |partition: usize| count * partition / partitions;
        let mut all = &mut self.rows.left[..];
        let pulled = &self.pulled;
        let parts = self.found.iter_mut().take(partitions).enumerate();
        let parts = parts.map(|(partition, found)| {
            let left = take(&mut all, border(partition + 1) - border(partition));
            (border(partition), left, found)
        });
        let work = |(first, left, found): (usize, &mut [f32], &mut Residuals)| {
            found.down.fill([0.0; LANES]);
            let above = first.saturating_sub(1);
            (kernels.note_places)(&blocks[above * strip..][..strip], found);
            for (row, left) in (first..).zip(left) {
                measure_row(blocks, row, None, grid, pulled, found, kernels);
                *left = found.across;
            }
        };
        if partitions > 1 {
            in_partitions(parts, work);
        } else {
            parts.for_each(work);
        }
        self.columns.left.fill(0.0);
        for found in &self.found[..partitions] {
            for (left, found) in self.columns.left.iter_mut().zip(&found.down) {
                *left = left.max(largest(*found));
            }
        }
    }

    /// Solves the chosen rows again, and measures what crosses them.
    fn solve_rows(&mut self, blocks: &mut [Block], grid: &mut GridSprings, kernels: &Kernels) {
        let (strip, count) = (self.strip, self.rows.left.len());
        let [in_rows, _] = &mut self.pulled;
        let mut rows = RowChains {
            blocks,
            first: 0,
            of: count,
            numbers: &self.rows.chosen,
            scratch: grid.rows,
            pulled: in_rows,
        };
        if rows.pulled.is_empty() {
            (kernels.solve_rows)(&mut rows, grid.across);
        } else {
            (kernels.solve_rows_again)(&mut rows, grid.across);
        }
        let found = &mut self.found[0];
        found.down.fill([0.0; LANES]);
        for &row in &self.rows.chosen {
            let row = row as usize;
            let above = row.saturating_sub(1);
            (kernels.note_places)(&blocks[above * strip..][..strip], found);
            for row in row..(row + 2).min(count) {
                measure_row(blocks, row, None, grid, &self.pulled, found, kernels);
                self.rows.left[row] = found.across;
            }
        }
        for (left, found) in self.columns.left.iter_mut().zip(&found.down) {
            *left = left.max(largest(*found));
        }
    }

    /// Solves the columns of the chosen blocks again.
    fn solve_columns(&mut self, blocks: &mut [Block], grid: &mut GridSprings, kernels: &Kernels) {
        let [_, from_above] = &mut self.pulled;
        let (links, before, behind) = grid.columns.memory();
        let mut columns = Columns {
            blocks,
            strip: self.strip,
            chosen: &self.columns.chosen,
            links,
            before,
            behind,
            pulled: from_above,
        };
        if columns.pulled.is_empty() {
            (kernels.solve_columns)(&mut columns, grid.down);
        } else {
            (kernels.solve_columns_again)(&mut columns, grid.down);
        }
        let chosen = &self.columns.chosen;
        let found = &mut self.found[0];
        found.down.fill([0.0; LANES]);
        (kernels.note_places)(&blocks[..self.strip], found);
        for (row, left) in self.rows.left.iter_mut().enumerate() {
            let at = Some(&chosen[..]);
            measure_row(blocks, row, at, grid, &self.pulled, found, kernels);
            *left = left.max(found.across);
        }
        for &block in chosen {
            let block = block as usize;
            self.columns.left[block] = largest(found.down[block]);
        }
    }
}

/// Measures what is left in a row, and between it and the one above: all of it, or at some blocks.
fn measure_row(
    blocks: &[Block],
    row: usize,
    at: Option<&[u32]>,
    grid: &GridSprings,
    pulled: &[Vec<Lanes>; 2],
    found: &mut Residuals,
    kernels: &Kernels,
) {
    let [border, inner] = grid.across;
    let strip = found.down.len();
    let is_border = row == 0 || (row + 1) * strip == blocks.len();
    let across = if is_border { border } else { inner };
    let own = row * strip..(row + 1) * strip;
    let blocks = &blocks[own.clone()];
    let is_elastic = !pulled[0].is_empty();
    let of_row = |pulled: &'_ Vec<Lanes>| {
        if is_elastic {
            own.clone()
        } else {
            0..pulled.len()
        }
    };
    let springs = RowSprings {
        kinds: [across, grid.down],
        first: [
            across.first_of(row),
            grid.down.first_of(row.saturating_sub(1)),
        ],
        pulled: [
            &pulled[0][of_row(&pulled[0])],
            &pulled[1][of_row(&pulled[1])],
        ],
    };
    match (at, is_elastic) {
        (None, false) => (kernels.measure_left)(blocks, &springs, found),
        (None, true) => (kernels.measure_elastic_left)(blocks, &springs, found),
        (Some(at), false) => (kernels.measure_left_at)(blocks, at, &springs, found),
        (Some(at), true) => (kernels.measure_elastic_left_at)(blocks, at, &springs, found),
    }
}
