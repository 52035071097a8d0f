//! How stiff a grid is: threads along its rows, columns and both diagonals.
//!
//! A thread's energy is `½ Σ k |x_{i−1} − 2 x_i + x_{i+1}|²`, with `k = a A ⁄ l⁴` of its rigidity a, the area A that a particle
//! stands for in it and its spacing l.
//!
//! ```text
//! \ | /    κ along a diagonal of a square is (κ_xx + κ_yy) ⁄ 2 ± κ_xy: with ⅔ of the rigidity in each direction
//! ― o ―    the energy is that of an isotropic plate whose Poisson's ratio is a third,
//! / | \    and that of a cylinder of any direction is ½ D κ² an area.
//! ```
//! Only what lies between particles on all sides has diagonals: a strip along a border, half a spacing wide, has all of the
//! rigidity in its thread.

use crate::cloth::{ClothGrid, Lanes, Layout};

/// k (N/m) of a grid's threads.
#[derive(Debug, Clone)]
pub(super) struct Plate {
    pub layout: Layout,
    /// Along the rows, down the columns: of threads in a border, and of those inside.
    across: [f32; 2],
    down: [f32; 2],
    oblique: f32,
}

impl Plate {
    /// Of this flexural rigidity (N·m).
    pub fn new(grid: &ClothGrid, rigidity: f32) -> Self {
        let (wide, high) = (f64::from(grid.spacing().x), f64::from(grid.spacing().y));
        let square = wide * wide + high * high;
        // Cosine and sine, squared, of a diagonal's direction.
        let (along, beside) = (wide * wide / square, high * high / square);
        let rigidity = f64::from(rigidity);
        // Of very long cells the diagonals can't be all that they should: no thread is weaker than none.
        let isotropic = rigidity / (6.0 * along * beside);
        let diagonal = isotropic
            .min(rigidity / (2.0 * along * along))
            .min(rigidity / (2.0 * beside * beside));
        let k =
            |rigidity: f64, width: f64, spacing: f64| (rigidity * width / spacing.powi(3)) as f32;
        let across = rigidity - 2.0 * diagonal * along * along;
        let down = rigidity - 2.0 * diagonal * beside * beside;
        Self {
            layout: Layout::new(grid.columns(), grid.rows()),
            across: [k(rigidity, high / 2.0, wide), k(across, high, wide)],
            down: [k(rigidity, wide / 2.0, high), k(down, wide, high)],
            oblique: (diagonal * wide * high / (square * square)) as f32,
        }
    }

    /// Of what bends along a row.
    pub fn across(&self, row: u32, column: u32) -> f32 {
        if is_inside(column, self.layout.columns) {
            self.across[usize::from(is_inside(row, self.layout.rows))]
        } else {
            0.0
        }
    }

    /// Of what bends down a column.
    pub fn down(&self, row: u32, column: u32) -> f32 {
        if is_inside(row, self.layout.rows) {
            self.down[usize::from(is_inside(column, self.layout.columns))]
        } else {
            0.0
        }
    }

    /// Of what bends along either diagonal.
    pub fn oblique(&self, row: u32, column: u32) -> f32 {
        if is_inside(row, self.layout.rows) && is_inside(column, self.layout.columns) {
            self.oblique
        } else {
            0.0
        }
    }

    /// Numbers of a row's particles, block by block; 0 where there is none.
    pub fn of_columns(&self, number: impl Fn(u32) -> f32) -> impl Iterator<Item = Lanes> {
        (0..self.layout.strip as usize).map(move |block| {
            let of = |lane: usize| self.layout.column(block, lane).map_or(0.0, &number);
            std::array::from_fn(of)
        })
    }
}

fn is_inside(index: u32, count: u32) -> bool {
    index > 0 && index + 1 < count
}
