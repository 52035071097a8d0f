//! Threads of a grid, and of a mesh, solved exactly.
//!
//! A thread is a chain of springs: a row, a column or a diagonal of a grid, a path of edges that go straight on in a mesh. One
//! sweep over its springs carries a correction one spring far, so that of a thread of n particles (n − 1)² g Δt² is left in
//! each sub-step. But the multipliers λ of all its springs together are no more than a tridiagonal system,
//!
//! ```text
//!   x₀ ──s₁── x₁ ──s₂── x₂ ──s₃── x₃        nᵢ: direction of spring i, Cᵢ: by how much it is too long
//!
//!   Aᵢᵢ = wᵢ₋₁ + wᵢ + α/(c Δt²)             Aᵢ,ᵢ₊₁ = −wᵢ nᵢ·nᵢ₊₁
//!   A λ = −C,                                Δxᵢ = wᵢ (λᵢ nᵢ − λᵢ₊₁ nᵢ₊₁)
//! ```
//!
//! which elimination solves in one pass there and one back (Thomas). Pins are particles of no inverse mass w, anywhere in it.
//! Everything is divided by lengths at rest and multiplied by lengths, so that no root is taken: two divisions a spring.
//!
//! **ε.** A rigid thread that is straight between two pins has one equation too many, and the system no solution. So the diagonal
//! is never softer than by the part ε = 10⁻³ of w, and by 0.2 of what a squared length is off: a thread between pins that are too
//! far apart pulls with C/ε, and would throw what is off its line far beyond it. A material that gives more than that is not
//! changed.
//!
//! **Order.** Diagonals first, then rows, then columns; what is solved last is held best. On a mesh all threads there and back:
//! one way only, a motion of second order gains energy.
//!
//! **Cost** (64², one thread, AVX2): 0.8 ns a spring of a column, 1.1 of a diagonal, 2 of a row, whose lanes have to be turned;
//! 24 µs a sub-step of all 16,000, where one sweep took 11.
//!
//! **Where it fails.** Each thread is exact by itself; what one leaves to the next is not. Where all the load hangs by one corner,
//! it passes from thread to thread, a step a sub-step: with too few of them the spring beside the pin stretches ([`needed`]). And
//! what tension does across a thread is explicit: its shortest ripple, of ω = 2 √(2 N ⁄ ρ) ⁄ h for a membrane of tension N and
//! spacing h, wants a sub-step below about 1.2 ⁄ ω (65² of cotton under 1 % of stretch: 40 in 1/64 s), or slow modes ring too low.
//!
//! [`needed`]: super::Substepping::needed

mod bands;
mod beside;
mod bundle;
mod bundles;
mod down;
mod link;
mod rows;
#[cfg(test)]
mod tests;

use std::ops::Range;

use super::{
    Stretch,
    bands::MAX_BANDS,
    kernel::{Kernels, Longest},
    run::Run,
    sweep::{Motion, Sweep, Swept},
};
use crate::cloth::{Block, ClothGrid, Compliances, LANES, Lanes, Layout};

pub(super) use bundle::{Solved, Step, bundle_backward, bundle_forward};
pub(super) use bundles::Bundles;
pub(super) use down::{
    Pull, clear, column_backward, column_forward, column_heads, left_backward, left_forward,
    left_heads, right_backward, right_forward,
};
pub(super) use link::{Family, Link, measure_given};
pub(super) use rows::{Rows, pull_row, row_equations, solve_turned, turn_back, turn_terms};

use bands::Part;
use rows::RowSystems;

/// Fewer rows a band than this, or fewer blocks of a row, and waiting for the others would take longer than the work.
const MIN_ROWS: usize = 32;
const MIN_BLOCKS: usize = 2;

/// Where threads lead that go from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Direction {
    Down,
    Right,
    Left,
}

/// The springs of a grid, thread by thread.
#[derive(Debug, Clone)]
pub(super) struct ThreadSweep {
    layout: Layout,
    /// Within a row: one on a border, one that is not.
    across: [Family; 2],
    down: Family,
    /// If there are any.
    diagonal: Option<Family>,
    /// For measuring: within a row, down, diagonal.
    runs: [Run; 3],
    /// Row by row.
    links: Vec<Link>,
    /// Of two rows.
    pulls: [Vec<Pull>; 2],
    /// One for each band.
    systems: Vec<RowSystems>,
    /// c Δt² (s²).
    weight_dt2: f32,
}

impl ThreadSweep {
    pub fn new(grid: &ClothGrid, compliances: &Compliances) -> Self {
        let layout = Layout::new(grid.columns(), grid.rows());
        let strip = layout.strip as usize;
        let family = |step, row| Family::new(grid, layout, compliances, step, row);
        let mut run =
            [(0, 1), (1, 0), (1, 1)].map(|step| Run::new(grid, layout, compliances, step, 0));
        for run in &mut run {
            run.soften(1.0);
        }
        Self {
            layout,
            across: [family((0, 1), 0), family((0, 1), 1)],
            down: family((1, 0), 0),
            diagonal: compliances.shear.is_finite().then(|| family((1, 1), 0)),
            runs: run,
            links: vec![Link::NONE; layout.blocks()],
            pulls: [0, 1].map(|_| vec![[[0.0; _]; 3]; strip]),
            systems: vec![RowSystems::new(strip)],
            weight_dt2: 0.0,
        }
    }

    /// Solves all threads that lead from row to row in one direction. Raises `given` to the squares of what their springs give
    /// at their tension (m²).
    fn solve_down(
        &mut self,
        blocks: &mut [Block],
        direction: Direction,
        kernels: &Kernels,
        mut given: Option<&mut Lanes>,
    ) {
        let strip = self.layout.strip as usize;
        let rows = self.layout.rows as usize;
        let Some(family) = (match direction {
            Direction::Down => Some(&self.down),
            Direction::Right | Direction::Left => self.diagonal.as_ref(),
        }) else {
            return;
        };
        let backward = match direction {
            Direction::Down => kernels.column_backward,
            Direction::Right => kernels.right_backward,
            Direction::Left => kernels.left_backward,
        };
        // The links before the first row's are none: so are those of the last row, where no spring begins.
        let none = (rows - 1) * strip;
        (kernels.clear)(&mut self.links[none..], &mut self.pulls[0]);
        let (links, none) = self.links.split_at_mut(none);
        for row in 0..rows - 1 {
            let (upper, lower) = blocks[row * strip..(row + 2) * strip].split_at(strip);
            let (before, own) = links.split_at_mut(row * strip);
            let before = if row == 0 {
                &*none
            } else {
                &before[(row - 1) * strip..]
            };
            let own = &mut own[..strip];
            match direction {
                Direction::Down => (kernels.column_forward)(upper, lower, before, own, family, 0),
                Direction::Right => (kernels.right_forward)(upper, lower, before, own, family),
                Direction::Left => (kernels.left_forward)(upper, lower, before, own, family),
            }
        }
        let [next, pulls] = &mut self.pulls;
        for row in (0..rows - 1).rev() {
            let lower = &mut blocks[(row + 1) * strip..(row + 2) * strip];
            backward(lower, &links[row * strip..(row + 1) * strip], next, pulls);
            if let Some(given) = &mut given {
                (kernels.measure_given)(pulls, &family.softness, given);
            }
            std::mem::swap(next, pulls);
        }
        let heads = if direction == Direction::Left {
            kernels.left_heads
        } else {
            kernels.column_heads
        };
        heads(&mut blocks[..strip], next);
    }

    /// Solves all threads within rows, likewise.
    fn solve_across(&mut self, blocks: &mut [Block], kernels: &Kernels, given: Option<&mut Lanes>) {
        let part = Part {
            blocks,
            first_row: 0,
            systems: &mut self.systems[0],
            given,
        };
        part.solve(self.layout, &self.across, kernels);
    }

    /// The lengths of the springs that begin in these rows.
    fn measure_rows(&self, blocks: &[Block], rows: Range<usize>, kernels: &Kernels) -> Longest {
        let mut longest = Longest::default();
        let strip = self.layout.strip as usize;
        let [across, down, diagonal] = &self.runs;
        for row in rows {
            let (upper, lower) = blocks[row * strip..].split_at(strip);
            (kernels.measure_within)(upper, across, &mut longest);
            if let Some(lower) = lower.get(..strip) {
                (kernels.measure_down)(upper, lower, down, &mut longest);
                if self.diagonal.is_some() {
                    (kernels.measure_diagonal)(upper, lower, diagonal, &mut longest);
                    (kernels.measure_diagonal)(lower, upper, diagonal, &mut longest);
                }
            }
        }
        longest
    }

    fn stretch(&self, longest: &Longest) -> Stretch {
        let ratio = |lanes: &Lanes, run: &Run| {
            (lanes.iter().copied().fold(0.0, f32::max) / run.rest_square).sqrt()
        };
        let structural =
            ratio(&longest.across, &self.runs[0]).max(ratio(&longest.down, &self.runs[1]));
        let bound = structural.max(ratio(&longest.diagonal, &self.runs[2]));
        Stretch::of_ratios(structural, bound)
    }
}

impl Sweep for ThreadSweep {
    fn set_weight(&mut self, weight_dt2: f32) {
        if self.weight_dt2 != weight_dt2 {
            self.weight_dt2 = weight_dt2;
            for family in self
                .across
                .iter_mut()
                .chain([&mut self.down])
                .chain(&mut self.diagonal)
            {
                family.soften(weight_dt2);
            }
        }
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn bands(&self, wanted: usize) -> usize {
        let (strip, rows) = (self.layout.strip as usize, self.layout.rows as usize);
        let most = (rows / MIN_ROWS).min(strip / MIN_BLOCKS);
        wanted.min(most).clamp(1, MAX_BANDS)
    }

    fn substep(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) -> Swept {
        let bands = self.bands(bands);
        if bands > 1 {
            return self.substep_in_bands(blocks, motion, bands);
        }
        let kernels = motion.kernels;
        self.solve_down(blocks, Direction::Right, kernels, None);
        self.solve_down(blocks, Direction::Left, kernels, None);
        let mut given = [0.0; LANES];
        self.solve_across(blocks, kernels, motion.measures.then_some(&mut given));
        let across = largest(&given) / self.across[0].rest;
        given = [0.0; LANES];
        let measured = motion.measures.then_some(&mut given);
        self.solve_down(blocks, Direction::Down, kernels, measured);
        let down = largest(&given) / self.down.rest;
        motion.tethers.pull(motion.anchors, blocks, 0, kernels);
        let mut moved = [0.0; LANES];
        (kernels.commit)(blocks, &mut moved);
        let stretch = motion.measures.then(|| Stretch {
            material: across.max(down),
            ..self.measure(blocks, kernels)
        });
        Swept { moved, stretch }
    }

    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch {
        let rows = 0..self.layout.rows as usize;
        self.stretch(&self.measure_rows(blocks, rows, kernels))
    }

    fn boxed(&self) -> Box<dyn Sweep> {
        Box::new(self.clone())
    }
}

/// The root of the largest of squares.
fn largest(squares: &Lanes) -> f32 {
    squares.iter().copied().fold(0.0, f32::max).sqrt()
}
