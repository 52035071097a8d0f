//! A tick of sub-steps: prediction, bending, springs, collision response.

mod explicit;
mod started;
#[cfg(test)]
mod tests;

use super::{
    bending::{Bending, ClothCreasing},
    chains::GridSolver,
    forces::Forces,
    free_pieces::FreePieces,
    kernels::SimdLevel,
    list::ListSolver,
    partitions::with_threads_awake,
    soft_springs::SoftSprings,
    spring_solver::SpringSolver,
    step::{PinMotion, SubStep, TickStep},
    stretch::Stretch,
    tether::{Anchors, Tethers},
    torn_grid::TornGridSolver,
};
use crate::cloth::{ClothMaterial, ClothParticles, Layout, SpringStorage, Springs, Surface};

pub(crate) use started::StartedTick;

/// Sub-steps of first order after one that ended with a push.
const AFTER_CONTACT: u32 = 3;

/// A stretch beyond the material's own that has not been solved: to go on from it would feed in energy.
const UNSOLVED: f32 = 0.5;

/// Ticks of first order after a tick that ended so stretched.
const WARY_TICKS: u32 = 15;

/// ω Δt up to which ripples of tension have the right speed. Springs pull along the predicted direction of their
/// chains. Beyond 2.3, on grids of 17² to 65² alike, the prediction overshoots, and a taut membrane rings lower, by 30
/// % at 3.9.
const RESOLVED: f32 = 2.2;

/// Simulates the particles that it was made for, one tick at a time. On one thread it does not allocate.
#[derive(Debug, Clone)]
pub struct Solver {
    /// Of the particles.
    layout: Layout,
    spring_solver: Box<dyn SpringSolver>,
    /// Of a grid without rigid springs.
    soft_springs: Option<Box<SoftSprings>>,
    bending: Option<Bending>,
    /// Those of a game, besides gravity.
    pub forces: Forces,
    tethers: Tethers,
    free_pieces: FreePieces,
    anchors: Anchors,
    /// Decay time of damping along springs (s).
    retardation: f32,
    partitions: usize,
    simd_level: SimdLevel,
}

impl Default for Solver {
    /// A solver without springs.
    fn default() -> Self {
        Self::of(Layout::default(), Box::<ListSolver>::default())
    }
}

impl Solver {
    /// A solver of `springs` between `particles`, without bending or tethers, on one thread.
    ///
    /// # Panics
    /// If the springs belong to another grid, or join more particles than there are.
    pub fn new(springs: &Springs, particles: &ClothParticles) -> Self {
        Self::of_layout(springs, particles.layout())
    }

    /// A solver of `springs` between the particles of a surface. Its clones share the data of the springs.
    ///
    /// # Panics
    /// See [`new`](Self::new).
    pub fn of_surface(surface: &Surface, springs: &Springs) -> Self {
        Self::of_layout(springs, surface.layout())
    }

    fn of_layout(springs: &Springs, layout: Layout) -> Self {
        // Particles that a caller made lie in one row.
        let on_grid = match springs.storage() {
            SpringStorage::List(list) => list
                .grid
                .as_ref()
                .filter(|grid| layout == Layout::of_torn_grid(grid.columns(), layout.len() as u32)),
            SpringStorage::Grid(..) => None,
        };
        let spring_solver: Box<dyn SpringSolver> = match springs.storage() {
            SpringStorage::Grid(grid, compliances) => {
                let of_grid = Layout::new(grid.columns(), grid.rows());
                assert!(layout == of_grid, "springs and particles of one grid");
                Box::new(GridSolver::new(grid, compliances))
            }
            SpringStorage::List(list) => {
                let mut ends = list.springs.iter().flat_map(|spring| spring.ends);
                let exists = |end: u32| (end as usize) < layout.len();
                assert!(ends.all(exists), "springs between particles that exist");
                match on_grid {
                    Some(grid) => Box::new(TornGridSolver::new(grid, list)),
                    None => Box::new(ListSolver::new(list, layout)),
                }
            }
        };
        let soft_springs = match springs.storage() {
            SpringStorage::Grid(grid, compliances) => {
                SoftSprings::new(grid, compliances).map(Box::new)
            }
            SpringStorage::List(list) => on_grid
                .and_then(|grid| SoftSprings::of_list(grid, layout, list))
                .map(Box::new),
        };
        Self {
            soft_springs,
            ..Self::of(layout, spring_solver)
        }
    }

    fn of(layout: Layout, spring_solver: Box<dyn SpringSolver>) -> Self {
        Self {
            layout,
            spring_solver,
            soft_springs: None,
            bending: None,
            forces: Forces::default(),
            tethers: Tethers::default(),
            free_pieces: FreePieces::default(),
            anchors: Anchors::default(),
            retardation: 0.0,
            partitions: 1,
            simd_level: SimdLevel::default(),
        }
    }

    /// Sets the resistance to bending, which must be that of the solver's particles; `None` for none.
    pub fn set_bending(&mut self, bending: Option<Bending>) {
        self.bending = bending;
    }

    /// Its resistance to bending.
    pub(crate) fn bending(&self) -> Option<&Bending> {
        self.bending.as_ref()
    }

    /// Sets how what resists its bending creases; `None` for not at all. `surface` and `material` are those that it was made with.
    pub(crate) fn set_creasing(
        &mut self,
        surface: &Surface,
        material: &ClothMaterial,
        creasing: Option<ClothCreasing>,
    ) {
        if let Some(bending) = &mut self.bending {
            bending.set_creasing(surface, material, creasing);
        }
    }

    /// The rest curvatures of its creases for the next tick; none if it does not crease.
    pub fn creases(&self) -> &[f32] {
        self.bending.as_ref().map_or(&[], Bending::creases)
    }

    /// Restores the creases from the last tick.
    pub(crate) fn recall_creases(&mut self, creases: &[f32]) {
        if let Some(bending) = &mut self.bending {
            bending.recall_creases(creases);
        }
    }

    /// Calls `visit` with the ends of each spring of a mesh, and its tension T L₀/L in the last sub-step (N).
    pub(crate) fn for_each_tension(&self, visit: &mut dyn FnMut([u32; 2], f32)) {
        self.spring_solver.for_each_tension(visit);
    }

    /// Sets the damping along springs: [`ClothMaterial::stretch_damping`](crate::cloth::ClothMaterial::stretch_damping)
    /// (s), 0 for none.
    pub fn set_stretch_damping(&mut self, retardation: f32) {
        self.retardation = retardation;
    }

    /// Sets tethers, which must be those of the solver's particles.
    pub fn set_tethers(&mut self, tethers: Tethers) {
        self.tethers = tethers;
    }

    /// Sets the pieces that no pin holds.
    pub(crate) fn set_free_pieces(&mut self, free_pieces: FreePieces) {
        self.free_pieces = free_pieces;
    }

    /// Takes over the tethers and free pieces of another solver of the same particles.
    pub(crate) fn take_tethers_of(&mut self, other: &mut Self) {
        self.tethers = std::mem::take(&mut other.tethers);
        self.free_pieces = std::mem::take(&mut other.free_pieces);
    }

    /// The tethers.
    pub fn tethers(&self) -> &Tethers {
        &self.tethers
    }

    /// Sets the number of partitions of rows, each a task of Bevy's compute pool. The result is the same to the last bit.
    /// Springs that don't belong to a grid are always one partition.
    pub fn set_partitions(&mut self, partitions: usize) {
        self.partitions = partitions;
        if let Some(soft_springs) = &mut self.soft_springs {
            soft_springs.set_partitions(partitions);
        }
    }

    /// Number of partitions: fewer than wanted if there is too little to do.
    pub(super) fn partitions(&self) -> usize {
        self.spring_solver.partitions(self.partitions)
    }

    /// Partitions in a tick of explicit springs.
    #[cfg(test)]
    pub(super) fn explicit_partitions(&self) -> usize {
        (self.soft_springs.as_ref()).map_or(1, |soft_springs| soft_springs.partitions())
    }

    /// Sets the SIMD level.
    #[doc(hidden)]
    pub fn set_simd_level(&mut self, simd_level: SimdLevel) {
        self.simd_level = simd_level;
    }

    /// Moves `particles` by one tick, and measures the stretch at its end. `respond` is called at the end of each
    /// sub-step, to push particles out of colliders, and returns whether it moved any. A tick of zero seconds does not
    /// move anything.
    ///
    /// # Panics
    /// If the solver was made for other particles.
    pub fn advance(
        &mut self,
        particles: &mut ClothParticles,
        step: TickStep,
        pins: &[PinMotion],
        mut respond: impl FnMut(&mut ClothParticles, SubStep) -> bool,
    ) -> Stretch {
        let mut tick = self.begin(particles, step, pins);
        with_threads_awake(self.partitions_of(&tick), || {
            while let Some(substep) = self.substep(particles, pins, &mut tick) {
                if respond(particles, substep) {
                    tick.note_push(particles);
                }
            }
        });
        self.end(particles, pins, tick)
    }

    /// Measures the stretch of `particles`.
    pub fn measure(&self, particles: &ClothParticles) -> Stretch {
        let kernels = self.simd_level.kernels();
        self.spring_solver.measure(particles.blocks(), &kernels)
    }
}
