//! The springs along the rows, columns and diagonals of a grid.

use std::ops::Range;

use crate::{
    cloth::{Block, ClothGrid, Compliances, LANES, Lanes, Layout, SpringList},
    solver::{
        kernels::{Direction, Kernels, Longest, SpringBand, StepScale, largest},
        stretch::Stretch,
    },
};

/// The springs of a grid, alike in each row or not.
#[derive(Debug, Clone)]
pub(super) struct GridBands {
    /// Within a row: one on a border, one that is not.
    pub across: [SpringBand; 2],
    pub down: SpringBand,
    /// To the right and to the left, if there are any.
    diagonals: Option<[SpringBand; 2]>,
}

impl GridBands {
    pub fn new(grid: &ClothGrid, layout: Layout, compliances: &Compliances) -> Self {
        let springs = |step, row| SpringBand::new(grid, layout, compliances, step, row);
        let has_diagonals = compliances.shear.is_finite();
        Self {
            across: [springs((0, 1), 0), springs((0, 1), 1)],
            down: springs((1, 0), 0),
            diagonals: has_diagonals.then(|| [(); 2].map(|()| springs((1, 1), 0))),
        }
    }

    /// Those in a list, each with a compliance of its own.
    pub fn of_list(grid: &ClothGrid, layout: Layout, list: &SpringList) -> Self {
        let (columns, rows) = (grid.columns() as usize, grid.rows() as usize);
        let [across, down, falling, rising] = &list.on_grid(grid);
        let band = |step, of: &[f32], direction: Direction| {
            SpringBand::of_rows(grid.step_length(step), layout, rows, |number, column| {
                let row = direction.row(number, rows);
                let compliance = of[row * columns + column as usize];
                (!compliance.is_nan()).then_some(compliance)
            })
        };
        let has_diagonals = falling.iter().chain(rising).any(|of| !of.is_nan());
        Self {
            across: [(); 2].map(|()| band((0, 1), across, Direction::Down)),
            down: band((1, 0), down, Direction::Down),
            diagonals: has_diagonals.then(|| {
                [(falling, Direction::Right), (rising, Direction::Left)]
                    .map(|(of, direction)| band((1, 1), of, direction))
            }),
        }
    }

    /// Those of chains from row to row.
    pub fn of(&self, direction: Direction) -> Option<&SpringBand> {
        match (direction, &self.diagonals) {
            (Direction::Down, _) => Some(&self.down),
            (Direction::Right, Some([right, _])) => Some(right),
            (Direction::Left, Some([_, left])) => Some(left),
            (_, None) => None,
        }
    }

    /// Whether those of a row or column give.
    pub fn is_elastic(&self) -> bool {
        let mut along = self.across.iter().chain([&self.down]);
        along.any(SpringBand::is_elastic)
    }

    /// Whether each row has springs of its own.
    pub fn is_by_row(&self) -> bool {
        self.down.first_of(1) > 0
    }

    /// Takes over the parameters of a sub-step.
    pub fn soften(&mut self, step_scale: StepScale) {
        let diagonals = self.diagonals.iter_mut().flatten();
        let along = self.across.iter_mut().chain([&mut self.down]);
        (along.chain(diagonals)).for_each(|springs| springs.soften(step_scale));
    }

    /// Tensions over lengths of the springs across and down together (N/m), lane by lane, from the largest elongations (m).
    pub fn tensions_of(&self, given: &[Lanes; 2]) -> Lanes {
        let mut sums = [0.0; LANES];
        for (given, springs) in given.iter().zip([&self.across[1], &self.down]) {
            let stiffness = springs.stiffness() * springs.inverse_rest;
            for (sum, given) in sums.iter_mut().zip(given) {
                *sum += given * stiffness;
            }
        }
        sums
    }

    /// The same from the multipliers of all springs (m kg).
    pub fn tensions(&self, pulled: &[Vec<Lanes>; 2], step_scale: StepScale) -> Lanes {
        let mut sums = [0.0; LANES];
        for (pulled, springs) in pulled.iter().zip([&self.across[1], &self.down]) {
            let scale = step_scale.inverse_weight * springs.inverse_rest;
            for (lane, sum) in sums.iter_mut().enumerate() {
                let pulls = pulled.iter().map(|pulls| pulls[lane].abs());
                *sum += scale * pulls.fold(0.0, f32::max);
            }
        }
        sums
    }

    /// The lengths of the springs that begin in these rows.
    pub fn measure_rows(
        &self,
        blocks: &[Block],
        layout: Layout,
        rows: Range<usize>,
        kernels: &Kernels,
    ) -> Longest {
        let mut longest = Longest::default();
        let strip = layout.strip as usize;
        let [across, _] = &self.across;
        let last = layout.rows as usize - 1;
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

    /// The stretch by the lengths of the longest springs.
    pub fn stretch(&self, longest: &Longest) -> Stretch {
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
    pub fn material(&self, [across, down]: &[Lanes; 2]) -> f32 {
        (largest(*across) / self.across[0].rest).max(largest(*down) / self.down.rest)
    }
}
