//! The bending of a stiff grid: its cells and chains solved, one family after the other.
//!
//! The matrix of a chain is constant and pentadiagonal; that of the cells between two columns is constant and
//! tridiagonal. Factored once into L D Lᵀ, they are solved exactly, eight at a time. The families are solved one after
//! the other, which is exact if the sub-step is small beside the period of a bend. Each of them takes energy away,
//! however stiff it is. Where only one of them resists, as in a strip that bends along its rows, nothing is lost.
//! Otherwise a plate becomes too soft: held at three corners, it sags by 5 % more where A, [`Push`](super::push)'s, is
//! 10, and by 27 % where it is 100.

use super::{
    factor::{factor_chain, factor_strip, set},
    grid_creases::Solve,
    plate::Plate,
};
use crate::{
    cloth::{Block, LANES, Lanes, Layout, MapInline, W},
    solver::kernels::{Factor, Kernels, Vec3Lanes},
};

/// Chains, or strips of cells, that have no particle in common.
#[derive(Debug, Clone)]
struct Family {
    solve: Solve,
    /// k (N/m) of a row's blocks, or pairs of blocks; of rows, that of each of eight rows, group by group. 0 where there is none.
    stiffness: Vec<Lanes>,
}

/// Factors of all families for some masses and a weight.
#[derive(Debug, Clone, Default)]
struct Factors {
    weight: f32,
    /// k s (kg), as the families' stiffness.
    stiffness: Vec<Vec<Lanes>>,
    /// Row by row; of rows, column by column, group by group.
    factors: Vec<Vec<Factor>>,
}

impl Factors {
    /// k s and factors of a family.
    fn of(&self, family: usize) -> (&[Lanes], &[Factor]) {
        (&self.stiffness[family], &self.factors[family])
    }
}

/// All chains and cells of a grid.
#[derive(Debug, Clone)]
pub(super) struct ChainBending {
    layout: Layout,
    families: Vec<Family>,
    /// Inverse masses that the factors are of (1/kg).
    inverse_masses: Vec<Lanes>,
    /// Those of the weights in use, the last one first.
    factors: [Factors; WEIGHTS],
    links: [Vec<Vec3Lanes>; 2],
    moments: [Vec<Vec3Lanes>; 3],
    solved: Vec<Vec3Lanes>,
    columns: Vec<Vec3Lanes>,
    none: (Vec<Vec3Lanes>, Vec<Factor>),
}

/// Weights that take turns: a method with a different start has three.
const WEIGHTS: usize = 3;

const NOTHING: [Lanes; 3] = [[0.0; LANES]; 3];

impl ChainBending {
    pub fn new(plate: &Plate) -> Self {
        let layout = plate.layout;
        let (rows, columns) = (layout.rows, layout.columns);
        let of_row = |row: u32| match row < rows {
            true => plate.across(row, 1),
            false => 0.0,
        };
        let of_rows = |group: usize| -> Lanes {
            std::array::from_fn(|lane| of_row((group * LANES + lane) as u32))
        };
        let groups = (rows as usize).div_ceil(LANES);
        let mut families = Vec::new();
        let mut add = |solve, stiffness| families.push(Family { solve, stiffness });
        if rows > 1 {
            let cells: Vec<Lanes> = plate.of_columns(|column| plate.twist(0, column)).collect();
            for is_odd in [false, true] {
                if columns > 1 + u32::from(is_odd) {
                    let first = usize::from(is_odd);
                    let of_pairs = cells.iter().skip(first).step_by(2);
                    add(Solve::Twist { is_odd }, of_pairs.copied().collect());
                }
            }
        }
        if rows > 2 {
            let stiffness = plate.of_columns(|column| plate.down(1, column));
            add(Solve::Down, stiffness.collect());
        }
        if columns > 2 {
            add(Solve::Across, (0..groups).map(of_rows).collect());
        }
        let strip = layout.strip as usize;
        let row = || vec![NOTHING; strip];
        let count = |family: &Family| match family.solve {
            Solve::Across => family.stiffness.len() * LANES * strip,
            _ => family.stiffness.len() * rows as usize,
        };
        let none = |of: &Family| vec![NOTHING; count(of)];
        let factors = Factors {
            weight: f32::NAN,
            stiffness: families.iter().map(|of| of.stiffness.clone()).collect(),
            factors: families.iter().map(none).collect(),
        };
        Self {
            layout,
            families,
            inverse_masses: vec![[f32::NAN; LANES]; layout.blocks()],
            // Room for all at once: no later step may ask for it.
            factors: std::array::from_fn(|_| factors.clone()),
            links: [row(), row()],
            moments: [row(), row(), row()],
            solved: vec![NOTHING; strip * rows as usize],
            columns: vec![NOTHING; LANES * strip],
            none: (row(), row()),
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
                *scaled = stiffness.map_inline(|stiffness| stiffness * weight);
            }
            self.factor(family, &factors.stiffness[at], &mut factors.factors[at]);
        }
        self.factors[0] = factors;
    }

    /// Factors all of a family.
    fn factor(&self, family: &Family, stiffness: &[Lanes], factors: &mut [Factor]) {
        let Layout { rows, columns, .. } = self.layout;
        let inverse_mass = |row: u32, column: u32| {
            let slot = self.layout.slot(row, column);
            f64::from(self.inverse_masses[slot.block][slot.lane])
        };
        let width = stiffness.len();
        match family.solve {
            Solve::Twist { is_odd } => {
                for column in (u32::from(is_odd)..columns - 1).step_by(2) {
                    let slot = self.layout.slot(0, column);
                    let pair = slot.block / 2;
                    factor_strip(
                        rows,
                        f64::from(stiffness[pair][slot.lane]),
                        |row| inverse_mass(row, column) + inverse_mass(row, column + 1),
                        |row, factor| {
                            set(&mut factors[row as usize * width + pair], slot.lane, factor);
                        },
                    );
                }
            }
            Solve::Down => {
                for column in 0..columns {
                    let slot = self.layout.slot(0, column);
                    factor_chain(
                        rows,
                        |row| inverse_mass(row, column),
                        f64::from(stiffness[slot.block][slot.lane]),
                        |row, factor| {
                            let at = row as usize * width + slot.block;
                            set(&mut factors[at], slot.lane, factor);
                        },
                    );
                }
            }
            Solve::Across => {
                let width = self.columns.len();
                for row in 0..rows {
                    let (group, lane) = (row as usize / LANES, row as usize % LANES);
                    let own = &mut factors[group * width..][..width];
                    factor_chain(
                        columns,
                        |column| inverse_mass(row, column),
                        f64::from(stiffness[group][lane]),
                        |column, factor| set(&mut own[column as usize], lane, factor),
                    );
                }
            }
        }
    }

    /// Solves family after family; `before` pushes at each of them first.
    pub fn solve(
        &mut self,
        blocks: &mut [Block],
        kernels: &Kernels,
        before: impl Fn(Solve, &mut [Block]),
    ) {
        for at in 0..self.families.len() {
            let solve = self.families[at].solve;
            before(solve, blocks);
            match solve {
                Solve::Twist { is_odd } => self.solve_cells(at, is_odd, blocks, kernels),
                Solve::Down => self.solve_columns(at, blocks, kernels),
                Solve::Across => self.solve_rows(at, blocks, kernels),
            }
        }
    }

    fn solve_cells(&mut self, at: usize, is_odd: bool, blocks: &mut [Block], kernels: &Kernels) {
        let strip = self.layout.strip as usize;
        let (rows, pairs) = (self.layout.rows as usize, strip / 2);
        let (stiffness, factors) = self.factors[0].of(at);
        let blocks_of = |row: usize| row * strip..(row + 1) * strip;
        let of = |row: usize| row * pairs..(row + 1) * pairs;
        let Self {
            links,
            moments: [moments, ..],
            solved,
            none,
            ..
        } = self;
        let [links, next_links] = links;
        let (mut own, mut next) = (&mut links[..pairs], &mut next_links[..pairs]);
        moments.fill(NOTHING);
        (kernels.twist_links)(&blocks[blocks_of(0)], is_odd, own);
        for row in 0..rows {
            // Below the last row is no cell: as if the next one were like it.
            let below = (row + 1).min(rows - 1);
            (kernels.twist_links)(&blocks[blocks_of(below)], is_odd, next);
            let (before, out) = solved.split_at_mut(row * pairs);
            let before = before.rchunks_exact(pairs).next().unwrap_or(&none.0);
            (kernels.twist_forward)(
                [own, next],
                stiffness,
                moments,
                before,
                &factors[of(row)],
                &mut out[..pairs],
            );
            (own, next) = (next, own);
        }
        for row in (0..rows).rev() {
            let (own, rest) = solved[row * pairs..].split_at_mut(pairs);
            let next = rest.get(..pairs).unwrap_or(&none.0);
            let below = factors.get(of(row + 1)).unwrap_or(&none.1);
            let row_factors = &factors[of(row)];
            let row = &mut blocks[blocks_of(row)];
            (kernels.twist_backward)(row, is_odd, [row_factors, below], next, own);
        }
    }

    fn solve_rows(&mut self, at: usize, blocks: &mut [Block], kernels: &Kernels) {
        let strip = self.layout.strip as usize;
        let (stiffness, factors) = self.factors[0].of(at);
        let factors = factors.chunks_exact(self.columns.len());
        let groups = blocks.chunks_mut(LANES * strip);
        let count = self.layout.columns as usize;
        for ((rows, stiffness), factors) in groups.zip(stiffness).zip(factors) {
            (kernels.chain_columns)(rows, strip, &mut self.columns);
            (kernels.chain_rows)(&mut self.columns[..count], stiffness, factors);
            // Beyond the last column are links to what is no particle.
            self.columns[count..].fill(NOTHING);
            (kernels.chain_finish)(&self.columns, strip, rows);
        }
    }

    fn solve_columns(&mut self, at: usize, blocks: &mut [Block], kernels: &Kernels) {
        let (rows, strip) = (self.layout.rows as usize, self.layout.strip as usize);
        let (stiffness, factors) = self.factors[0].of(at);
        let of = |row: usize| row * strip..(row + 1) * strip;
        let factors_of = |row: usize| factors.get(of(row)).unwrap_or(&self.none.1);
        for moments in &mut self.moments {
            moments.fill(NOTHING);
        }
        for next in 0..=rows {
            if next + 1 < rows {
                let links = &mut self.links[next % 2];
                (kernels.chain_links)(&blocks[of(next)], &blocks[of(next + 1)], links);
                if next > 0 {
                    let links = [&*self.links[(next + 1) % 2], &*self.links[next % 2]];
                    (kernels.chain_moments)(links, stiffness, &mut self.moments[next % 3]);
                }
            } else {
                self.moments[next % 3].fill(NOTHING);
            }
            let Some(row) = next.checked_sub(1) else {
                continue;
            };
            let moments = [row + 2, row, row + 1].map_inline(|row| &*self.moments[row % 3]);
            let (solved, rest) = self.solved.split_at_mut(row * strip);
            let solved = |back: usize| match row.checked_sub(back) {
                Some(row) => &solved[of(row)],
                None => &self.none.0,
            };
            let solved = [solved(1), solved(2)];
            (kernels.chain_forward)(moments, solved, factors_of(row), &mut rest[..strip]);
        }
        for row in (0..rows).rev() {
            let (own, rest) = self.solved[row * strip..].split_at_mut(strip);
            let solved = [0, 1].map_inline(|on| rest.get(of(on)).unwrap_or(&self.none.0));
            (kernels.chain_backward)(
                &mut blocks[of(row)],
                factors_of(row),
                solved,
                [factors_of(row + 1), factors_of(row + 2)],
                own,
            );
        }
    }
}
