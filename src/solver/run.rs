//! Springs of a grid that lie alike.

use crate::cloth::{ClothGrid, Compliances, Lanes, Layout};

/// Added to `w_a + w_b` (1/kg): negligible, but it keeps a spring between two pins from dividing by zero.
pub(super) const MIN_SOFTNESS: f32 = 1.0e-18;

/// Springs that lie alike: one block of them for each block of a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    pub rest_square: f32,
    /// Compliance (m/N), infinite where there is no spring.
    compliance: Vec<Lanes>,
    /// α/Δt² (1/kg).
    pub softness: Vec<Lanes>,
}

impl Run {
    /// The springs that begin in `row` of `grid`; one row stands for all like it.
    pub fn new(
        grid: &ClothGrid,
        layout: Layout,
        compliances: &Compliances,
        step: (u32, i32),
        row: u32,
    ) -> Self {
        let compliance = |block: usize, lane: usize| {
            let column = layout.column(block, lane)?;
            let end = column.checked_add_signed(step.1)?;
            let row = row.min(grid.rows().saturating_sub(1));
            (end < grid.columns()).then_some(())?;
            compliances.of_strip(grid, step, (row, column))
        };
        let lanes = |block: usize| {
            std::array::from_fn(|lane| compliance(block, lane).unwrap_or(f32::INFINITY))
        };
        let rest = grid.step_length(step);
        let compliance: Vec<Lanes> = (0..layout.strip as usize).map(lanes).collect();
        Self {
            rest_square: rest * rest,
            softness: compliance.clone(),
            compliance,
        }
    }

    pub fn soften(&mut self, inverse_dt2: f32) {
        for (softness, compliance) in self.softness.iter_mut().zip(&self.compliance) {
            for (softness, compliance) in softness.iter_mut().zip(compliance) {
                *softness = compliance * inverse_dt2 + MIN_SOFTNESS;
            }
        }
    }
}
