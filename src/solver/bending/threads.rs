//! The bending of a stiff grid: its threads solved, one direction after the other.
//!
//! A thread's matrix is constant and pentadiagonal, factored once into L D Lᵀ and solved exactly, eight threads at a time. The four
//! directions are solved one after the other, which is as exact as the sub-step is small beside the period of a bend; each by
//! itself takes energy away, however stiff it is.

use super::{
    factor::{factor_thread, set},
    plate::Plate,
};
use crate::{
    cloth::{Block, LANES, Lanes, Layout, W},
    solver::{
        kernel::Kernels,
        thread::{Factor, GHOSTS, Trio, wrap},
    },
};

/// Which way a family of threads leads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Along the rows.
    Across,
    /// Down the columns.
    Down,
    /// Down and to the right.
    Falling,
    /// Up and to the right.
    Rising,
}

/// Threads side by side.
#[derive(Debug, Clone)]
struct Family {
    way: Way,
    /// k (N/m) of a row's blocks; of rows, that of each of eight rows, group by group. 0 where there is no particle on both sides.
    stiffness: Vec<Lanes>,
}

/// What masses and a weight make of all families.
#[derive(Debug, Clone, Default)]
struct Factors {
    weight: f32,
    /// k s (kg), as the families' stiffness.
    stiffness: Vec<Vec<Lanes>>,
    /// Row by row in the order of the threads, with ghosts; of rows, column by column, group by group.
    factors: Vec<Vec<Factor>>,
}

/// All threads of a grid.
#[derive(Debug, Clone)]
pub(super) struct ThreadBending {
    layout: Layout,
    families: Vec<Family>,
    /// Inverse masses that the factors are of (1/kg).
    inverse_masses: Vec<Lanes>,
    /// Those of the weights in use, the last one first.
    factors: [Factors; WEIGHTS],
    links: [Vec<Trio>; 2],
    moments: [Vec<Trio>; 3],
    solved: Vec<Trio>,
    columns: Vec<Trio>,
    none: (Vec<Trio>, Vec<Factor>),
}

/// Weights that take turns: a method that starts otherwise than it goes on has three.
const WEIGHTS: usize = 3;

const NOTHING: [Lanes; 3] = [[0.0; LANES]; 3];

impl ThreadBending {
    pub fn new(plate: &Plate) -> Self {
        let layout = plate.layout;
        let (rows, columns) = (layout.rows, layout.columns);
        let of_rows = |group: usize| -> Lanes {
            std::array::from_fn(|lane| {
                let row = (group * LANES + lane) as u32;
                if row < rows {
                    plate.across(row, 1)
                } else {
                    0.0
                }
            })
        };
        let groups = (rows as usize).div_ceil(LANES);
        let mut families = Vec::new();
        let mut add = |way, stiffness| families.push(Family { way, stiffness });
        if rows > 2 && columns > 2 {
            for way in [Way::Falling, Way::Rising] {
                let stiffness = plate.of_columns(|column| plate.oblique(1, column));
                add(way, stiffness.collect());
            }
        }
        if rows > 2 {
            let stiffness = plate.of_columns(|column| plate.down(1, column));
            add(Way::Down, stiffness.collect());
        }
        if columns > 2 {
            add(Way::Across, (0..groups).map(of_rows).collect());
        }
        let strip = layout.strip as usize;
        let stride = strip + 2 * GHOSTS;
        let row = || vec![NOTHING; stride];
        let mut new = Self {
            layout,
            families,
            inverse_masses: vec![[f32::NAN; LANES]; layout.blocks()],
            factors: Default::default(),
            links: [row(), row()],
            moments: [row(), row(), row()],
            solved: vec![NOTHING; stride * rows as usize],
            columns: vec![NOTHING; LANES * strip],
            none: (row(), row()),
        };
        // Room for all at once: no later step may ask for it.
        new.factors = std::array::from_fn(|_| new.no_factors());
        new
    }

    /// Room for those of a weight.
    fn no_factors(&self) -> Factors {
        let stride = self.layout.strip as usize + 2 * GHOSTS;
        let rows = self.layout.rows as usize;
        let count = |family: &Family| match family.way {
            Way::Across => family.stiffness.len() * self.columns.len(),
            _ => stride * rows,
        };
        Factors {
            weight: f32::NAN,
            stiffness: self
                .families
                .iter()
                .map(|of| of.stiffness.clone())
                .collect(),
            factors: self
                .families
                .iter()
                .map(|of| vec![NOTHING; count(of)])
                .collect(),
        }
    }

    pub fn prepare(&mut self, blocks: &[Block], weight: f32) {
        let mut has_other_masses = false;
        for (own, block) in self.inverse_masses.iter_mut().zip(blocks) {
            let of = &block.view()[W..W + LANES];
            if own != of {
                own.copy_from_slice(of);
                has_other_masses = true;
            }
        }
        if has_other_masses {
            for factors in &mut self.factors {
                factors.weight = f32::NAN;
            }
        }
        let place = |of: &dyn Fn(f32) -> bool| self.factors.iter().position(|own| of(own.weight));
        if let Some(known) = place(&|own| own == weight) {
            self.factors[..=known].rotate_right(1);
            return;
        }
        let unused = place(&|own| own.is_nan()).unwrap_or(WEIGHTS - 1);
        self.factors[..=unused].rotate_right(1);
        let mut factors = std::mem::take(&mut self.factors[0]);
        factors.weight = weight;
        for (at, family) in self.families.iter().enumerate() {
            for (scaled, stiffness) in factors.stiffness[at].iter_mut().zip(&family.stiffness) {
                *scaled = stiffness.map(|stiffness| stiffness * weight);
            }
            self.factor(family, &factors.stiffness[at], &mut factors.factors[at]);
        }
        self.factors[0] = factors;
    }

    /// Factors all threads of a family.
    fn factor(&self, family: &Family, stiffness: &[Lanes], factors: &mut [Factor]) {
        let Layout { rows, columns, .. } = self.layout;
        let inverse_mass = |row: u32, column: u32| {
            let slot = self.layout.slot(row, column);
            f64::from(self.inverse_masses[slot.block][slot.lane])
        };
        if family.way == Way::Across {
            let width = self.columns.len();
            for row in 0..rows {
                let (group, lane) = (row as usize / LANES, row as usize % LANES);
                let own = &mut factors[group * width..][..width];
                let k = f64::from(stiffness[group][lane]);
                factor_thread(
                    columns,
                    |column| inverse_mass(row, column),
                    |_| k,
                    |column, factor| set(&mut own[column as usize], lane, factor),
                );
            }
            return;
        }
        let strip = self.layout.strip as usize;
        let stride = strip + 2 * GHOSTS;
        let shift = family.way.shift() as u32;
        // Each thread begins in the first row or, of diagonals, in the first column.
        let beside = if shift == 0 {
            0
        } else {
            rows.saturating_sub(1)
        };
        let starts = (0..columns).map(|column| (0, column));
        for (first, column) in starts.chain((1..=beside).map(|row| (row, 0))) {
            let down = rows - first;
            let count = if shift == 0 {
                down
            } else {
                down.min(columns - column)
            };
            let cell = |at: u32| (first + at, column + at * shift);
            factor_thread(
                count,
                |at| {
                    let (row, column) = cell(at);
                    inverse_mass(family.way.row(row, rows), column)
                },
                |at| {
                    let slot = self.layout.slot(0, cell(at).1);
                    f64::from(stiffness[slot.block][slot.lane])
                },
                |at, factor| {
                    let (row, column) = cell(at);
                    let slot = self.layout.slot(0, column);
                    let at = row as usize * stride + GHOSTS + slot.block;
                    set(&mut factors[at], slot.lane, factor);
                },
            );
        }
        if shift > 0 {
            for row in factors.chunks_exact_mut(stride) {
                wrap(row);
            }
        }
    }

    pub fn solve(&mut self, blocks: &mut [Block], kernels: &Kernels) {
        for at in 0..self.families.len() {
            match self.families[at].way {
                Way::Across => self.solve_rows(at, blocks, kernels),
                way => self.solve_down(at, way, blocks, kernels),
            }
        }
    }

    fn solve_rows(&mut self, at: usize, blocks: &mut [Block], kernels: &Kernels) {
        let strip = self.layout.strip as usize;
        let Factors {
            stiffness, factors, ..
        } = &self.factors[0];
        let factors = factors[at].chunks_exact(self.columns.len());
        let groups = blocks.chunks_mut(LANES * strip);
        let count = self.layout.columns as usize;
        for ((rows, stiffness), factors) in groups.zip(&stiffness[at]).zip(factors) {
            (kernels.thread_columns)(rows, strip, &mut self.columns);
            (kernels.thread_rows)(&mut self.columns[..count], stiffness, factors);
            // Beyond the last column are links to what is no particle.
            self.columns[count..].fill(NOTHING);
            (kernels.thread_finish)(&self.columns, strip, rows);
        }
    }

    fn solve_down(&mut self, at: usize, way: Way, blocks: &mut [Block], kernels: &Kernels) {
        let (rows, strip) = (self.layout.rows as usize, self.layout.strip as usize);
        let stride = strip + 2 * GHOSTS;
        let shift = way.shift();
        let Factors {
            stiffness, factors, ..
        } = &self.factors[0];
        let (stiffness, factors) = (&stiffness[at], &factors[at]);
        let factors_of = |row: usize| {
            factors
                .get(row * stride..(row + 1) * stride)
                .unwrap_or(&self.none.1)
        };
        let place = |row: usize| way.row(row as u32, rows as u32) as usize * strip;
        for moments in &mut self.moments {
            moments.fill(NOTHING);
        }
        for next in 0..=rows {
            if next + 1 < rows {
                let (from, to) = (place(next), place(next + 1));
                let links = &mut self.links[next % 2];
                (kernels.thread_links)(
                    &blocks[from..from + strip],
                    &blocks[to..to + strip],
                    shift,
                    links,
                );
                if next > 0 {
                    let links = [&*self.links[(next + 1) % 2], &*self.links[next % 2]];
                    let moments = &mut self.moments[next % 3];
                    (kernels.thread_moments)(links, shift, stiffness, moments);
                }
            } else {
                self.moments[next % 3].fill(NOTHING);
            }
            let Some(row) = next.checked_sub(1) else {
                continue;
            };
            let [a, b, c] = [row + 2, row, row + 1].map(|row| &*self.moments[row % 3]);
            let (solved, rest) = self.solved.split_at_mut(row * stride);
            let solved = |back: usize| match row.checked_sub(back) {
                Some(row) => &solved[row * stride..(row + 1) * stride],
                None => &self.none.0,
            };
            (kernels.thread_forward)(
                [a, b, c],
                [solved(1), solved(2)],
                factors_of(row),
                shift,
                &mut rest[..stride],
            );
        }
        for row in (0..rows).rev() {
            let (own, rest) = self.solved[row * stride..].split_at_mut(stride);
            let solved = |on: usize| {
                rest.get((on - 1) * stride..on * stride)
                    .unwrap_or(&self.none.0)
            };
            let from = place(row);
            (kernels.thread_backward)(
                &mut blocks[from..from + strip],
                factors_of(row),
                [solved(1), solved(2)],
                [factors_of(row + 1), factors_of(row + 2)],
                shift,
                own,
            );
        }
    }
}

impl Way {
    /// Columns to the right from row to row.
    fn shift(self) -> usize {
        usize::from(matches!(self, Self::Falling | Self::Rising))
    }

    /// The row of a thread's row: what leads up begins with the last one.
    fn row(self, row: u32, rows: u32) -> u32 {
        match self {
            Self::Rising => rows - 1 - row,
            _ => row,
        }
    }
}
