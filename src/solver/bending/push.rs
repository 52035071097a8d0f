//! The bending forces of a grid that is soft enough to be pushed by them.
//!
//! The solution of `(M + s K) (p + e) = M p` is the series `e = −A p + A² p − …` with `A = s M⁻¹ K`. Where A is small
//! its first term is enough. For each ripple, the rest is at most the fraction of e that is A's eigenvalue for it,
//! which falls with the fourth power of the ripple's length. Like the solution, the first term takes energy away, and
//! it is stable as long as A is below one.

use super::plate::Plate;
use crate::{
    cloth::{Block, LANES, Lanes, Layout, MapInline, W, larger},
    solver::kernels::{EDGE, Kernels, Moments, Stiffness, Vec3Lanes},
};

/// Forces push where A is below this: the fastest bending mode, a ripple from particle to particle, gets at most a
/// fifth too much.
pub(super) const LIMIT: f32 = 0.2;

/// Rows of each end that differ from those further inside.
const ENDS: usize = 3;

/// All forces of a grid.
#[derive(Debug, Clone)]
pub(super) struct Push {
    rows: usize,
    strip: usize,
    /// Of the first row and the last, and then of those between; or of each row, if rows differ.
    stiffness: Vec<Stiffness>,
    rows_differ: bool,
    /// Bounds of a row's sum of K (N/m): of the first or last row, the second from there, and others.
    bounds: [Vec<Lanes>; ENDS],
    places: [Vec<Vec3Lanes>; 3],
    moments: [Vec<Moments>; 3],
}

impl Push {
    pub fn new(plate: &Plate) -> Self {
        let layout = plate.layout;
        let stiffness = [0, 1].map(|row| {
            let of = |number: &dyn Fn(u32) -> f32| plate.of_columns(number).collect::<Vec<_>>();
            let across = of(&|column| plate.across(row, column));
            let down = of(&|column| plate.down(row, column));
            let twist = of(&|column| plate.twist(row, column));
            let all = across.into_iter().zip(down).zip(twist);
            let all = all.map(|((across, down), twist)| [across, down, twist]);
            all.collect::<Vec<_>>()
        });
        let bounds = [0, 1, 2].map_inline(|row| {
            let bounds = plate.of_columns(|column| bound(plate, row, column));
            bounds.collect()
        });
        Self {
            bounds,
            rows_differ: false,
            ..Self::of_rows(layout, stiffness.concat())
        }
    }

    /// Of rows of their own, whose bounds somebody else knows.
    pub fn of_rows(layout: Layout, stiffness: Vec<Stiffness>) -> Self {
        let (rows, strip) = (layout.rows as usize, layout.strip as usize);
        let row = || vec![[[0.0; LANES]; 3]; strip + 2 * EDGE];
        let moments = || vec![Moments::default(); strip + 2 * EDGE];
        Self {
            rows,
            strip,
            stiffness,
            rows_differ: true,
            bounds: Default::default(),
            places: [row(), row(), row()],
            moments: [moments(), moments(), moments()],
        }
    }

    /// A bound of A's largest eigenvalue, with this weight s (s²).
    pub fn bound(&self, blocks: &[Block], weight: f32) -> f32 {
        let mut largest = [0.0; LANES];
        for (row, blocks) in blocks.chunks_exact(self.strip).enumerate() {
            let end = row.min(self.rows - 1 - row).min(ENDS - 1);
            for (block, bound) in blocks.iter().zip(&self.bounds[end]) {
                let view = block.view();
                for l in 0..LANES {
                    largest[l] = larger(view[W + l] * bound[l], largest[l]);
                }
            }
        }
        weight * largest.into_iter().fold(0.0, f32::max)
    }

    /// Adds the forces' share to displacements: of the forces where this part of the displacements leads to.
    pub fn apply(&mut self, blocks: &mut [Block], part: f32, weight: f32, kernels: &Kernels) {
        let (rows, strip) = (self.rows, self.strip);
        let Some(first) = blocks.first() else {
            return;
        };
        let origin = first.position(0).to_array();
        let row = |row: usize| row * strip..(row + 1) * strip;
        // Beyond the first row.
        self.moments[2].fill(Moments::default());
        (kernels.plate_places)(&blocks[row(0)], &origin, part, &mut self.places[0]);
        for next in 0..=rows {
            if next + 1 < rows {
                let places = &mut self.places[(next + 1) % 3];
                (kernels.plate_places)(&blocks[row(next + 1)], &origin, part, places);
            }
            let moments = &mut self.moments[next % 3];
            if next < rows {
                // A row at the end has no moments down the columns, and the last one, which is its own next one, no twist.
                let above = next.saturating_sub(1);
                let below = (next + 1).min(rows - 1);
                let places = [above, next, below].map_inline(|row| &*self.places[row % 3]);
                let is_inside = next > 0 && next + 1 < rows;
                let of = match self.rows_differ {
                    true => next,
                    false => usize::from(is_inside),
                };
                let stiffness = &self.stiffness[of * strip..][..strip];
                (kernels.plate_moments)(places, stiffness, moments);
            } else {
                moments.fill(Moments::default());
            }
            if let Some(own) = next.checked_sub(1) {
                let moments = [own + 2, own, own + 1].map_inline(|row| &*self.moments[row % 3]);
                (kernels.plate_push)(moments, weight, &mut blocks[row(own)]);
            }
        }
    }
}

/// A bound of the largest eigenvalue of `M⁻¹ K` (1/s²), from sums of the absolute values in each particle's row of K (N/m).
pub(super) fn largest_bound(blocks: &[Block], bounds: &[Lanes]) -> f32 {
    let mut largest = 0.0_f32;
    for (block, bounds) in blocks.iter().zip(bounds) {
        let weights = &block.view()[W..W + LANES];
        for (weight, bound) in weights.iter().zip(bounds) {
            largest = largest.max(weight * bound);
        }
    }
    largest
}

/// Upper bound of the sum of absolute values in a particle's row of K (N/m).
fn bound(plate: &Plate, row: u32, column: u32) -> f32 {
    let of = |k: &dyn Fn(u32, u32) -> f32, down: i32, right: i32| {
        let cell = (row.checked_add_signed(down)).zip(column.checked_add_signed(right));
        cell.map_or(0.0, |(row, column)| k(row, column))
    };
    let across = |right| of(&|row, column| plate.across(row, column), 0, right);
    let down = |down| of(&|row, column| plate.down(row, column), down, 0);
    let twist = |down, right| of(&|row, column| plate.twist(row, column), down, right);
    let beside = across(-1) + across(1) + down(-1) + down(1);
    let cells = twist(-1, -1) + twist(-1, 0) + twist(0, -1) + twist(0, 0);
    4.0 * (beside + cells) + 8.0 * (across(0) + down(0))
}
