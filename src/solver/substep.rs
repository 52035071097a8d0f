//! A tick of sub-steps: prediction, bending, springs, response.

mod explicit;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use super::{
    Bending, PinMotion, SimdLevel, Stretch, SubStep, Tethers, TickStep, TimeOrder,
    bands::{in_bands, with_threads_awake},
    energy::Energy,
    forces::Forces,
    list::ListSweep,
    pace::Pace,
    pipeline::GridSweep,
    predict::{Prediction, weight},
    spin::Spin,
    step::{DAMPING_REFERENCE, existing, put_pins},
    sweep::{Motion, Sweep},
    tether::Anchors,
    threads::ThreadSweep,
};
use crate::cloth::{ClothParticles, Layout, SpringStorage, Springs, StepKind, Surface};

/// Sub-steps of first order after one that ended with a push.
const AFTER_CONTACT: u32 = 3;

/// A stretch beyond the material's own that has not been solved: to go on from it would feed in energy.
const UNSOLVED: f32 = 0.5;

/// Ticks of first order after a tick that ended so stretched.
const WARY_TICKS: u32 = 15;

/// ω Δt up to which ripples of tension are as fast as they are. Springs pull along where their threads are foreseen to be: beyond 2.3,
/// on grids of 17² to 65² alike, what is foreseen goes beyond what it comes from, and a taut membrane rings lower, by 30 % at 3.9.
const RESOLVED: f32 = 2.2;

/// Moves the particles that it was made for, a tick at a time. On one thread it does not allocate.
#[derive(Debug, Clone)]
pub struct Solver {
    /// Of the particles.
    layout: Layout,
    sweep: Box<dyn Sweep>,
    /// Of a grid without rigid springs.
    forces: Option<Box<Forces>>,
    bending: Option<Bending>,
    tethers: Tethers,
    anchors: Anchors,
    /// Of damping along springs (s).
    retardation: f32,
    bands: usize,
    simd_level: SimdLevel,
}

impl Default for Solver {
    /// Of no springs.
    fn default() -> Self {
        Self::of(Layout::default(), Box::<ListSweep>::default())
    }
}

impl Solver {
    /// Solves `springs` between `particles`. Without bending or tethers, on one thread.
    ///
    /// # Panics
    /// If the springs are those of another grid, or between more particles than there are.
    pub fn new(springs: &Springs, particles: &ClothParticles) -> Self {
        Self::of_layout(springs, particles.layout())
    }

    /// Solves `springs` by one sweep over them in each sub-step, spring after spring, which is of first order in time: what the
    /// lab compares with.
    ///
    /// # Panics
    /// As [`new`](Self::new) does.
    #[doc(hidden)]
    pub fn of_one_sweep(springs: &Springs, particles: &ClothParticles) -> Self {
        match springs.storage() {
            SpringStorage::Grid(grid, compliances) if particles.layout().strip > 1 => {
                let sweep = Box::new(GridSweep::new(grid, compliances));
                Self::of(particles.layout(), sweep)
            }
            SpringStorage::List(list) => {
                let list = Arc::new(list.without_threads());
                let sweep = Box::new(ListSweep::new(&list, particles.layout()));
                Self::of(particles.layout(), sweep)
            }
            SpringStorage::Grid(..) => Self::new(springs, particles),
        }
    }

    /// Solves `springs` between the particles of a surface. Its clones share what it knows of the springs.
    ///
    /// # Panics
    /// As [`new`](Self::new) does.
    pub fn of_surface(surface: &Surface, springs: &Springs) -> Self {
        Self::of_layout(springs, Layout::of(surface))
    }

    fn of_layout(springs: &Springs, layout: Layout) -> Self {
        let sweep: Box<dyn Sweep> = match springs.storage() {
            SpringStorage::Grid(grid, compliances) => {
                let of_grid = Layout::new(grid.columns(), grid.rows());
                assert!(layout == of_grid, "springs and particles of one grid");
                Box::new(ThreadSweep::new(grid, compliances))
            }
            SpringStorage::List(list) => {
                let mut ends = list.springs.iter().flat_map(|spring| spring.ends);
                let exists = |end: u32| (end as usize) < layout.len();
                assert!(ends.all(exists), "springs between particles that exist");
                Box::new(ListSweep::new(list, layout))
            }
        };
        let forces = match springs.storage() {
            SpringStorage::Grid(grid, compliances) => Forces::new(grid, compliances).map(Box::new),
            SpringStorage::List(_) => None,
        };
        Self {
            forces,
            ..Self::of(layout, sweep)
        }
    }

    fn of(layout: Layout, sweep: Box<dyn Sweep>) -> Self {
        Self {
            layout,
            sweep,
            forces: None,
            bending: None,
            tethers: Tethers::default(),
            anchors: Anchors::default(),
            retardation: 0.0,
            bands: 1,
            simd_level: SimdLevel::default(),
        }
    }

    /// With this resistance to bending from now on, which must be that of the solver's particles; `None` for none.
    pub fn set_bending(&mut self, bending: Option<Bending>) {
        self.bending = bending;
    }

    /// With damping along springs from now on: [`ClothMaterial::stretch_damping`](crate::cloth::ClothMaterial::stretch_damping)
    /// (s), 0 for none.
    pub fn set_stretch_damping(&mut self, retardation: f32) {
        self.retardation = retardation;
    }

    /// With tethers from now on, which must be those of the solver's particles.
    pub fn set_tethers(&mut self, tethers: Tethers) {
        self.tethers = tethers;
    }

    /// Its tethers, for another solver of the same particles. It has none from now on.
    pub(crate) fn take_tethers(&mut self) -> Tethers {
        std::mem::take(&mut self.tethers)
    }

    /// The tethers.
    pub fn tethers(&self) -> &Tethers {
        &self.tethers
    }

    /// With this many bands of rows from now on, each a task of Bevy's compute pool. The result is the same to the
    /// last bit. Springs on no grid are always one band.
    pub fn set_bands(&mut self, bands: usize) {
        self.bands = bands;
        if let Some(forces) = &mut self.forces {
            forces.set_bands(bands);
        }
    }

    /// How many bands there are: fewer than wanted where there is too little to do.
    pub(super) fn bands(&self) -> usize {
        self.sweep.bands(self.bands)
    }

    /// Bands in a tick of forces.
    #[cfg(test)]
    pub(super) fn forces_bands(&self) -> usize {
        self.forces.as_ref().map_or(1, |forces| forces.bands())
    }

    /// With this SIMD level from now on.
    #[doc(hidden)]
    pub fn set_simd_level(&mut self, simd_level: SimdLevel) {
        self.simd_level = simd_level;
    }

    /// Moves `particles` by one tick and measures the stretch that it ends with. `respond` is called at the end of
    /// each sub-step, to push particles out of what they touch, and says whether it moved any. No time, no motion.
    ///
    /// # Panics
    /// If the particles are others than those that the solver was made for.
    pub fn advance(
        &mut self,
        particles: &mut ClothParticles,
        step: TickStep,
        pins: &[PinMotion],
        mut respond: impl FnMut(&mut ClothParticles, SubStep) -> bool,
    ) -> Stretch {
        let step = self.allowed(step);
        assert!(
            particles.layout() == self.layout,
            "particles of the solver's own"
        );
        if step.seconds <= 0.0 {
            return self.measure(particles);
        }
        let dt = step.seconds / step.substeps.max(1) as f32;
        if self.is_explicit(particles, &step) {
            return self.advance_by_forces(particles, step, pins, &mut respond);
        }
        let watched = Energy::watched(particles, dt, step.acceleration);
        particles.set_substep(dt);
        particles.zero_pin_displacements();
        if step.order == TimeOrder::First {
            particles.past_mut().forget(0);
        }
        let bands = self.bands();
        // What else turns the cloth, or carries it in another way, is not known here.
        let spin = Spin::of(particles, &step, pins);
        let mut is_pushed = false;
        let mut respond = |particles: &mut ClothParticles, substep| {
            let pushes = respond(particles, substep);
            is_pushed |= pushes;
            pushes
        };
        let (measured, ripple) =
            with_threads_awake(bands, || self.substeps(particles, step, pins, &mut respond));
        let stretch = Stretch {
            ripple_substeps: step.seconds * ripple / RESOLVED,
            ..measured.unwrap_or_else(|| self.measure(particles))
        };
        let is_still = pins.iter().all(|pin| pin.from == pin.to);
        // What the material gives comes back by itself, and what pushes or carries a cloth gives it energy.
        let given = step.material_stretch.max(stretch.material);
        let is_unsolved = stretch.structural > 2.0 * given;
        if let Some(before) = watched
            && is_unsolved
            && is_still
            && !is_pushed
        {
            before.limit(particles, step.acceleration);
        } else {
            particles.past_mut().set_lost(0.0);
        }
        particles.past_mut().set_moved();
        if let Some(spin) = spin
            && !is_pushed
        {
            let kept = (1.0 - step.damping).powf(step.seconds / DAMPING_REFERENCE);
            spin.restore(particles, kept);
        }
        put_pins(particles, pins);
        if stretch.structural > step.material_stretch + UNSOLVED {
            particles.past_mut().forget(WARY_TICKS * step.substeps);
        }
        stretch
    }

    /// A step of the order that is safe with what solves the springs.
    fn allowed(&self, step: TickStep) -> TickStep {
        let order = if self.sweep.is_exact() {
            step.order
        } else {
            TimeOrder::First
        };
        TickStep { order, ..step }
    }

    /// All sub-steps of a tick. Returns the stretch where it was measured on the way, and the frequency of ripples (rad/s).
    fn substeps(
        &mut self,
        particles: &mut ClothParticles,
        step: TickStep,
        pins: &[PinMotion],
        respond: &mut impl FnMut(&mut ClothParticles, SubStep) -> bool,
    ) -> (Option<Stretch>, f32) {
        let count = step.substeps.max(1);
        let dt = step.seconds / count as f32;
        let kept = (1.0 - step.damping).powf(dt / DAMPING_REFERENCE);
        let kernels = self.simd_level.kernels();
        let bands = self.bands();
        let (mut measured, mut ripple) = (None, 0.0);
        for index in 0..count {
            let mut substep = SubStep {
                index,
                count,
                farthest_move: 0.0,
            };
            for pin in existing(pins, particles.len()) {
                particles
                    .set_pin_target(pin.particle as usize, pin.from.lerp(pin.to, substep.end()));
            }
            self.tethers.locate(particles.blocks(), &mut self.anchors);
            let kind = match step.order {
                TimeOrder::First => StepKind::First,
                TimeOrder::Second => particles.next_step(),
            };
            let weight_dt2 = weight(kind) * dt * dt;
            let pull = (step.acceleration * weight_dt2).to_array();
            let prediction = Prediction::new(kind, kept, pull);
            let (blocks, past) = particles.blocks_and_past();
            match step.order {
                TimeOrder::First => (kernels.predict_first)(blocks, &prediction),
                TimeOrder::Second if bands > 1 => {
                    let size = blocks.len().div_ceil(bands);
                    let parts = blocks.chunks_mut(size).zip(past.chunks_mut(size));
                    in_bands(parts, |(blocks, past)| {
                        (kernels.predict)(blocks, past, &prediction);
                    });
                }
                TimeOrder::Second => (kernels.predict)(blocks, past, &prediction),
            }
            if let Some(bending) = &mut self.bending {
                bending.prepare(blocks, weight_dt2);
                bending.solve(blocks, &kernels);
            }
            self.sweep
                .set_pace(Pace::new(weight_dt2, dt, self.retardation));
            let motion = Motion {
                kernels: &kernels,
                tethers: &self.tethers,
                anchors: &self.anchors,
                measures: index + 1 == count,
            };
            let swept = self.sweep.substep(blocks, &motion, self.bands);
            if kind == StepKind::Start {
                (kernels.begin_past)(blocks, past);
            }
            (measured, ripple) = (swept.stretch, swept.ripple);
            substep.farthest_move = swept.moved.into_iter().fold(0.0, f32::max).sqrt();
            if respond(particles, substep) {
                measured = None;
                particles.forget_past(AFTER_CONTACT);
            }
        }
        (measured, ripple)
    }

    /// Measures the stretch of `particles`.
    pub fn measure(&self, particles: &ClothParticles) -> Stretch {
        let kernels = self.simd_level.kernels();
        self.sweep.measure(particles.blocks(), &kernels)
    }
}
