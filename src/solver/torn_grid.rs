//! The springs of a grid that is torn or mapped: those between its neighbours as a grid's, whose stiffness differs from place to
//! place, and those of the particles that tears made as a mesh's.
//!
//! The springs of new particles are solved before the rows and columns, and once more after them, in the opposite order. So what
//! they leave is symmetric, as in a mesh.

use super::{
    chains::GridSolver,
    kernels::{Kernels, StepScale},
    list::ListSolver,
    spring_solver::{Motion, SolvedSubstep, SpringSolver},
    stretch::Stretch,
};
use crate::cloth::{Block, ClothGrid, Layout, Slot, Spring, SpringList};

#[derive(Debug, Clone)]
pub(super) struct TornGridSolver {
    grid: GridSolver,
    /// Springs with an end that a tear made.
    list: ListSolver,
    /// Where the particles of these springs are.
    slots: Vec<Slot>,
}

impl TornGridSolver {
    /// Of springs of this grid. The particles are laid out as a torn grid's.
    pub fn new(grid: &ClothGrid, springs: &SpringList) -> Self {
        let count = grid.len() as u32;
        let (list, particles) = springs.beyond(count);
        let last = particles.last().map_or(count, |last| last + 1);
        let layout = Layout::of_torn_grid(grid.columns(), last.max(count));
        let own = Layout::new(particles.len() as u32, 1);
        Self {
            grid: GridSolver::of_list(grid, springs),
            list: ListSolver::new(&list.into(), own),
            slots: particles
                .iter()
                .map(|particle| layout.slot_of(*particle as usize))
                .collect(),
        }
    }
}

impl SpringSolver for TornGridSolver {
    fn set_step_scale(&mut self, step_scale: StepScale) {
        self.grid.set_step_scale(step_scale);
        self.list.set_step_scale(step_scale);
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn partitions(&self, wanted: usize) -> usize {
        self.grid.partitions(wanted)
    }

    fn substep(
        &mut self,
        blocks: &mut [Block],
        motion: &Motion,
        partitions: usize,
    ) -> SolvedSubstep {
        let kernels = motion.kernels;
        let partitions = self.partitions(partitions);
        let count = self.grid.blocks();
        (self.grid).solve_diagonals(&mut blocks[..count], kernels, partitions);
        self.list.load_from(&self.slots, blocks);
        self.list.solve_there(kernels);
        self.list.store_to(&self.slots, blocks);
        (self.grid).solve_along(&mut blocks[..count], kernels, partitions);
        self.list.load_from(&self.slots, blocks);
        self.list.solve_back(kernels);
        self.list.store_to(&self.slots, blocks);
        (self.grid).solve_again(&mut blocks[..count], motion, partitions);
        let mut solved = self.grid.end(blocks, motion, partitions);
        if let Some(of_grid) = solved.stretch {
            let [material, _] = self.list.tensions();
            solved.stretch = Some(Stretch {
                material: of_grid.material.max(material),
                ..self.with_list(of_grid, blocks)
            });
        }
        solved
    }

    fn measure(&self, blocks: &[Block], kernels: &Kernels) -> Stretch {
        self.with_list(self.grid.measure(blocks, kernels), blocks)
    }

    fn boxed(&self) -> Box<dyn SpringSolver> {
        Box::new(self.clone())
    }
}

impl TornGridSolver {
    /// The stretch of the grid's springs and of those in the list together.
    fn with_list(&self, of_grid: Stretch, blocks: &[Block]) -> Stretch {
        let place = |end: u32| {
            let slot = self.slots[end as usize];
            blocks[slot.block].position(slot.lane)
        };
        let square = |spring: &Spring| {
            let [a, b] = spring.ends;
            place(a).distance_squared(place(b))
        };
        let of_list = self.list.stretch(square);
        Stretch {
            structural: of_grid.structural.max(of_list.structural),
            bound: of_grid.bound.max(of_list.bound),
            ..of_grid
        }
    }
}
