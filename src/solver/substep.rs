//! A tick of sub-steps: Verlet, one sweep over the springs, response.

#[cfg(test)]
mod tests;

use bevy::math::Vec3;

use super::{
    Instructions, Stretch, Tethers,
    bands::with_threads_awake,
    list::ListSweep,
    spin::Spin,
    tether::Anchors,
    wave::{GridSweep, Motion},
};
use crate::cloth::{ClothParticles, Layout, Springs, Weave};

/// The time step for which the paper's damping D is given (s).
pub(super) const DAMPING_REFERENCE: f32 = 1.0 / 60.0;

/// What moves a cloth in a tick, besides its springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TickStep {
    /// Length of the tick (s).
    pub seconds: f32,
    /// Sub-steps in it, at least 1.
    pub substeps: u32,
    /// Acceleration in the cloth's frame (m/s²).
    pub acceleration: Vec3,
    /// The paper's D: the part of its velocity that the cloth loses in 1/60 s.
    pub damping: f32,
}

impl Default for TickStep {
    /// 20 sub-steps of Bevy's 64 Hz, no acceleration, no damping.
    fn default() -> Self {
        Self {
            seconds: 1.0 / 64.0,
            substeps: 20,
            acceleration: Vec3::ZERO,
            damping: 0.0,
        }
    }
}

/// One sub-step of a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubStep {
    /// Which one, from 0.
    pub index: u32,
    /// How many there are.
    pub count: u32,
    /// How far the particle that moved farthest in it has moved (m).
    pub farthest_move: f32,
}

impl SubStep {
    /// The part of the tick that has passed when this sub-step ends, up to 1.
    pub fn end(&self) -> f32 {
        (self.index + 1) as f32 / self.count as f32
    }
}

/// A pinned particle that its cloth's frame, or whatever it is pinned to, carries along in a tick. One of a particle that
/// does not exist moves nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinMotion {
    /// Index of the particle.
    pub particle: u32,
    /// Where it is as the tick begins (m).
    pub from: Vec3,
    /// Where it is as the tick ends (m).
    pub to: Vec3,
}

/// Moves the particles that it was made for, a tick at a time. On one thread it does not allocate.
#[derive(Debug, Clone, PartialEq)]
pub struct Solver {
    /// Of the particles.
    layout: Layout,
    sweep: Sweep,
    tethers: Tethers,
    anchors: Anchors,
    bands: usize,
    instructions: Instructions,
}

#[derive(Debug, Clone, PartialEq)]
enum Sweep {
    Grid(Box<GridSweep>),
    /// With the springs, for the stretch.
    List(ListSweep, Springs),
}

impl Default for Solver {
    /// Of no springs.
    fn default() -> Self {
        Self::of(
            Layout::default(),
            Sweep::List(ListSweep::default(), Springs::default()),
        )
    }
}

impl Solver {
    /// Solves `springs` between `particles`. Without tethers, on one thread.
    ///
    /// # Panics
    /// If the springs are those of another grid, or between more particles than there are.
    pub fn new(springs: &Springs, particles: &ClothParticles) -> Self {
        let layout = particles.layout();
        match springs.weave() {
            Weave::Grid(grid, _) => {
                assert!(particles.fit(grid), "springs and particles of one grid");
            }
            Weave::List(list, _) => {
                let mut ends = list.iter().flat_map(|spring| spring.ends);
                let exists = |end: u32| (end as usize) < particles.len();
                assert!(ends.all(exists), "springs between particles that exist");
            }
        }
        let sweep = match springs.weave() {
            Weave::Grid(grid, compliances) => {
                Sweep::Grid(Box::new(GridSweep::new(grid, compliances)))
            }
            Weave::List(list, colours) => {
                Sweep::List(ListSweep::new(list, colours, layout), springs.clone())
            }
        };
        Self::of(layout, sweep)
    }

    fn of(layout: Layout, sweep: Sweep) -> Self {
        Self {
            layout,
            sweep,
            tethers: Tethers::default(),
            anchors: Anchors::default(),
            bands: 1,
            instructions: Instructions::default(),
        }
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

    /// With so many bands of rows from now on, each a task of Bevy's compute pool. The result is the same to the
    /// last bit. Springs on no grid are always one band.
    pub fn set_bands(&mut self, bands: usize) {
        self.bands = bands;
    }

    /// With these instructions from now on.
    pub fn set_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
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
        assert!(
            particles.layout() == self.layout,
            "particles of the solver's own"
        );
        if step.seconds <= 0.0 {
            return self.measure(particles);
        }
        let dt = step.seconds / step.substeps.max(1) as f32;
        particles.respan(dt);
        particles.still_pins();
        match &mut self.sweep {
            Sweep::Grid(sweep) => sweep.soften(dt),
            Sweep::List(sweep, _) => sweep.soften(dt),
        }
        let bands = match &self.sweep {
            Sweep::Grid(sweep) => sweep.bands(self.bands),
            Sweep::List(..) => 1,
        };
        // What else turns the cloth, or carries it in another way, is not known here.
        let spin = Spin::of(particles, &step, pins);
        let mut is_pushed = false;
        let mut respond = |particles: &mut ClothParticles, substep| {
            let pushes = respond(particles, substep);
            is_pushed |= pushes;
            pushes
        };
        let measured =
            with_threads_awake(bands, || self.substeps(particles, step, pins, &mut respond));
        if let Some(spin) = spin
            && !is_pushed
        {
            let kept = (1.0 - step.damping).powf(step.seconds / DAMPING_REFERENCE);
            spin.restore(particles, kept);
        }
        for pin in existing(pins, particles.len()) {
            // Not a rounding beside it.
            particles.put(pin.particle as usize, pin.to);
        }
        measured.unwrap_or_else(|| self.measure(particles))
    }

    /// All sub-steps of a tick. Returns the stretch where it was measured on the way.
    fn substeps(
        &mut self,
        particles: &mut ClothParticles,
        step: TickStep,
        pins: &[PinMotion],
        respond: &mut impl FnMut(&mut ClothParticles, SubStep) -> bool,
    ) -> Option<Stretch> {
        let count = step.substeps.max(1);
        let dt = step.seconds / count as f32;
        let kept = (1.0 - step.damping).powf(dt / DAMPING_REFERENCE);
        let kernels = self.instructions.kernels();
        let mut measured = None;
        for index in 0..count {
            let mut substep = SubStep {
                index,
                count,
                farthest_move: 0.0,
            };
            for pin in existing(pins, particles.len()) {
                particles.lead_pin(pin.particle as usize, pin.from.lerp(pin.to, substep.end()));
            }
            self.tethers.locate(particles.blocks(), &mut self.anchors);
            let motion = Motion {
                kernels: &kernels,
                kept,
                acceleration_dt2: (step.acceleration * (dt * dt)).to_array(),
                tethers: &self.tethers,
                anchors: &self.anchors,
                measures: index + 1 == count,
            };
            let blocks = particles.blocks_mut();
            let farthest = match &self.sweep {
                Sweep::Grid(sweep) => {
                    let longest = sweep.substep(blocks, &motion, self.bands);
                    if motion.measures {
                        let (structural, bound) = sweep.ratios(&longest);
                        measured = Some(Stretch::of_ratios(structural, bound));
                    }
                    longest.moved
                }
                Sweep::List(sweep, _) => sweep.substep(blocks, &motion),
            };
            substep.farthest_move = farthest.into_iter().fold(0.0, f32::max).sqrt();
            if respond(particles, substep) {
                measured = None;
            }
        }
        measured
    }

    /// Measures the stretch of `particles`.
    pub fn measure(&self, particles: &ClothParticles) -> Stretch {
        match &self.sweep {
            Sweep::Grid(sweep) => {
                let kernels = self.instructions.kernels();
                let (structural, bound) =
                    sweep.ratios(&sweep.measure(particles.blocks(), &kernels));
                Stretch::of_ratios(structural, bound)
            }
            Sweep::List(_, springs) => Stretch::measure(springs, particles),
        }
    }
}

/// Those of particles that exist.
fn existing(pins: &[PinMotion], particles: usize) -> impl Iterator<Item = &PinMotion> {
    pins.iter()
        .filter(move |pin| (pin.particle as usize) < particles)
}
