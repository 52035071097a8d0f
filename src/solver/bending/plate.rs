//! How stiff a grid is: chains along its rows and columns, and its cells against twist.
//!
//! A strip of cloth is to bend as a beam of the rigidity D times its width, whatever its width and however its free edges curl.
//! That is a plate whose Poisson's ratio is 0, of the energy `½ D (κ_xx² + κ_yy² + 2 κ_xy²)` an area, as meshes have it too. It is
//! never negative. For a cylinder of any direction φ it is ½ D κ², as `κ_xx`, `κ_yy` and `κ_xy` are κ cos²φ, κ sin²φ
//! and κ cos φ sin φ:
//!
//! ```text
//!  o ― o ― o    κ_xx along three particles of a row, k = D × width ⁄ spacing³ of ½ k |x₋ − 2 x + x₊|²,
//!  |   |   |    κ_yy likewise down a column; a chain of a border is half a spacing wide.
//!  o ― o ― o    κ_xy in a cell, k = 2 D ⁄ area of ½ k |x₀₀ − x₀₁ − x₁₀ + x₁₁|².
//! ```
//! A woven cloth has D of the weft along rows, that of the warp along columns, and `√(D_weft D_warp)` against twist (Huber
//! 1923): a cylinder of direction φ then has `½ (√D_weft cos²φ + √D_warp sin²φ)² κ²`.
//! Each of the three is exact where the curvature is the same everywhere, in rectangular cells as in square ones. Together they
//! are the plate's difference equation of 13 points, whose error is of second order in the spacing. Chains of four directions
//! would have a Poisson's ratio of a third whatever their rigidities: strips of them are too soft, as their free edges curl.

use crate::cloth::{ClothGrid, Lanes, Layout};

/// k (N/m) of a grid's chains and cells.
#[derive(Debug, Clone)]
pub(super) struct Plate {
    pub layout: Layout,
    /// Of chains inside; those in a border have half of it.
    across: f32,
    down: f32,
    twist: f32,
}

impl Plate {
    /// Of these flexural rigidities along rows and along columns (N·m).
    pub fn new(grid: &ClothGrid, rigidities: [f32; 2]) -> Self {
        let (wide, high) = (f64::from(grid.spacing().x), f64::from(grid.spacing().y));
        let [across, down] = rigidities.map(f64::from);
        Self {
            layout: Layout::new(grid.columns(), grid.rows()),
            across: (across * high / wide.powi(3)) as f32,
            down: (down * wide / high.powi(3)) as f32,
            twist: (2.0 * (across * down).sqrt() / (wide * high)) as f32,
        }
    }

    /// Of what bends along a row, down a column, and of a cell, if all of it is inside.
    pub fn inside(&self) -> [f32; 3] {
        [self.across, self.down, self.twist]
    }

    /// Of what bends along a row.
    pub fn across(&self, row: u32, column: u32) -> f32 {
        let Layout { rows, columns, .. } = self.layout;
        chain(self.across, (column, columns), (row, rows))
    }

    /// Of what bends down a column.
    pub fn down(&self, row: u32, column: u32) -> f32 {
        let Layout { rows, columns, .. } = self.layout;
        chain(self.down, (row, rows), (column, columns))
    }

    /// Of the cell whose upper left corner is this particle.
    pub fn twist(&self, row: u32, column: u32) -> f32 {
        let is_cell = row + 1 < self.layout.rows && column + 1 < self.layout.columns;
        if is_cell { self.twist } else { 0.0 }
    }

    /// Numbers of a row's particles, block by block; 0 where there is none.
    pub fn of_columns(&self, number: impl Fn(u32) -> f32) -> impl Iterator<Item = Lanes> {
        (0..self.layout.strip as usize).map(move |block| {
            let of = |lane: usize| self.layout.column(block, lane).map_or(0.0, &number);
            std::array::from_fn(of)
        })
    }
}

/// `inside`, half of it in a border or 0 at a chain's end, by the place along the chain and that beside other chains.
fn chain(inside: f32, along: (u32, u32), beside: (u32, u32)) -> f32 {
    let is_inside = |(at, count): (u32, u32)| at > 0 && at + 1 < count;
    match (is_inside(along), is_inside(beside)) {
        (false, _) => 0.0,
        (true, false) => inside / 2.0,
        (true, true) => inside,
    }
}
