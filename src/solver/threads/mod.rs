//! Threads of a grid, and of a mesh, solved exactly.

mod bundle;
mod bundles;
mod down;
mod link;
mod rows;
#[cfg(test)]
mod tests;

use super::{
    Stretch,
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

use rows::{GROUP, RowSystems};

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
    systems: RowSystems,
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
            systems: RowSystems::new(strip),
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
        let family = match direction {
            Direction::Down => &self.down,
            Direction::Right | Direction::Left => match &self.diagonal {
                Some(family) => family,
                None => return,
            },
        };
        let (forward, backward) = match direction {
            Direction::Down => (kernels.column_forward, kernels.column_backward),
            Direction::Right => (kernels.right_forward, kernels.right_backward),
            Direction::Left => (kernels.left_forward, kernels.left_backward),
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
            forward(upper, lower, before, &mut own[..strip], family);
        }
        let [next, pulls] = &mut self.pulls;
        for row in (0..rows - 1).rev() {
            let lower = &mut blocks[(row + 1) * strip..(row + 2) * strip];
            backward(lower, &links[row * strip..(row + 1) * strip], next, pulls);
            if let Some(given) = &mut given {
                (kernels.measure_given)(pulls, family, given);
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

    fn solve_across(
        &mut self,
        blocks: &mut [Block],
        kernels: &Kernels,
        mut given: Option<&mut Lanes>,
    ) {
        let strip = self.layout.strip as usize;
        let rows = self.layout.rows as usize;
        let springs = self.layout.columns as usize - 1;
        for (group, blocks) in blocks.chunks_mut(strip * GROUP).enumerate() {
            let is_border = [group == 0, (group + 1) * GROUP >= rows];
            self.systems
                .solve(blocks, &self.across, is_border, springs, kernels);
            if let Some(given) = &mut given {
                self.systems.measure_given(
                    &self.across,
                    is_border,
                    blocks.len() / strip,
                    kernels,
                    given,
                );
            }
        }
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

    fn bands(&self, _: usize) -> usize {
        1
    }

    fn substep(&mut self, blocks: &mut [Block], motion: &Motion, _: usize) -> Swept {
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
        let mut longest = Longest::default();
        let strip = self.layout.strip as usize;
        let [across, down, diagonal] = &self.runs;
        for (row, upper) in blocks.chunks_exact(strip).enumerate() {
            (kernels.measure_within)(upper, across, &mut longest);
            if let Some(lower) = blocks.get((row + 1) * strip..(row + 2) * strip) {
                (kernels.measure_down)(upper, lower, down, &mut longest);
                if self.diagonal.is_some() {
                    (kernels.measure_diagonal)(upper, lower, diagonal, &mut longest);
                    (kernels.measure_diagonal)(lower, upper, diagonal, &mut longest);
                }
            }
        }
        self.stretch(&longest)
    }

    fn boxed(&self) -> Box<dyn Sweep> {
        Box::new(self.clone())
    }
}

/// The root of the largest of squares.
fn largest(squares: &Lanes) -> f32 {
    squares.iter().copied().fold(0.0, f32::max).sqrt()
}
