//! The systems of threads within rows, and who solves them.

use super::{
    link::Family,
    rows::{GROUP, Rows},
};
use crate::{
    cloth::{Block, LANES, Lanes, Layout},
    solver::kernel::Kernels,
};

/// The systems of a group of rows.
#[derive(Debug, Default, Clone)]
pub(crate) struct RowSystems {
    /// Row by row, block by block.
    ways: Vec<[Lanes; 3]>,
    /// Row by row, block by block: diagonal, off, right.
    terms: Vec<[Lanes; 3]>,
    /// Column by column, of all rows: the same.
    unknowns: Vec<[Rows; 3]>,
}

/// A row where there is none: nothing pulls.
const NO_TERMS: [Lanes; 3] = [[1.0; LANES], [0.0; LANES], [0.0; LANES]];

impl RowSystems {
    pub fn new(strip: usize) -> Self {
        let columns = strip * LANES;
        Self {
            ways: vec![[[0.0; LANES]; 3]; strip * GROUP],
            terms: vec![NO_TERMS; strip * GROUP],
            unknowns: vec![[[0.0; GROUP]; 3]; columns],
        }
    }

    /// Solves the rows in `blocks`, up to [`GROUP`] of them, of `springs` springs each; with the family of a border for the
    /// first and the last of them where they are on one.
    pub fn solve(
        &mut self,
        blocks: &mut [Block],
        [border, inner]: &[Family; 2],
        is_border: [bool; 2],
        springs: usize,
        kernels: &Kernels,
    ) {
        let strip = border.hold.len();
        let count = blocks.len() / strip;
        for (row, blocks) in blocks.chunks_exact(strip).enumerate() {
            let is_border = (row == 0 && is_border[0]) || (row + 1 == count && is_border[1]);
            let family = if is_border { border } else { inner };
            let range = row * strip..(row + 1) * strip;
            let (ways, terms) = (&mut self.ways[range.clone()], &mut self.terms[range]);
            (kernels.row_equations)(blocks, family, ways, terms);
        }
        self.terms[count * strip..].fill(NO_TERMS);
        (kernels.turn_terms)(&self.terms, &mut self.unknowns, strip);
        (kernels.solve_turned)(&mut self.unknowns, springs);
        (kernels.turn_back)(&self.unknowns, &mut self.terms, strip);
        for (row, blocks) in blocks.chunks_exact_mut(strip).enumerate() {
            let range = row * strip..(row + 1) * strip;
            (kernels.pull_row)(blocks, &mut self.ways[range.clone()], &self.terms[range]);
        }
    }

    /// Raises `largest` to the squares of what the springs of the rows solved last, this many, give at their tension (m²).
    pub fn measure_given(
        &self,
        families: &[Family; 2],
        is_border: [bool; 2],
        count: usize,
        kernels: &Kernels,
        largest: &mut Lanes,
    ) {
        let strip = families[0].hold.len();
        for (row, pulls) in self.ways.chunks_exact(strip).take(count).enumerate() {
            let is_border = (row == 0 && is_border[0]) || (row + 1 == count && is_border[1]);
            let family = &families[usize::from(!is_border)];
            (kernels.measure_given)(pulls, &family.softness, largest);
        }
    }
}

/// Rows that lie one below the other, and what solves them.
pub(super) struct Part<'a> {
    pub blocks: &'a mut [Block],
    pub first_row: usize,
    pub systems: &'a mut RowSystems,
    /// To be raised to the squares of what springs give at their tension (m²).
    pub given: Option<&'a mut Lanes>,
}

impl Part<'_> {
    /// Solves the threads within its rows, of a kind on the grid's borders and one that is not.
    pub fn solve(mut self, layout: Layout, families: &[Family; 2], kernels: &Kernels) {
        let strip = layout.strip as usize;
        let springs = layout.columns as usize - 1;
        let mut row = self.first_row;
        for blocks in self.blocks.chunks_mut(strip * GROUP) {
            let count = blocks.len() / strip;
            let is_border = [row == 0, row + count == layout.rows as usize];
            let systems = &mut *self.systems;
            systems.solve(blocks, families, is_border, springs, kernels);
            if let Some(given) = &mut self.given {
                systems.measure_given(families, is_border, count, kernels, given);
            }
            row += count;
        }
    }
}
