//! A tick of sub-steps: Verlet, one sweep over the springs, response.

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::{Cloth, ClothMaterial, Pins, Spring, SpringKind};

    /// Beyond the end there is nothing to move, in the last block's unused lanes neither.
    #[test]
    fn a_pin_beyond_the_particles_moves_nothing() {
        let (mut particles, springs) = cloth(&ClothMaterial::COTTON, &Pins::top_row());
        let mut expected = particles.clone();
        let beyond = [30, 31, 1000, u32::MAX].map(|particle| PinMotion {
            particle,
            from: Vec3::ZERO,
            to: Vec3::splat(5.0),
        });
        advance(&mut particles, &springs, TickStep::default(), &beyond);
        advance(&mut expected, &springs, TickStep::default(), &[]);
        assert_eq!(particles, expected);
    }

    #[test]
    #[should_panic(expected = "springs between particles that exist")]
    fn springs_beyond_the_particles_are_refused_at_once() {
        let spring = Spring {
            kind: SpringKind::Structural,
            ends: [3, 9],
            rest_length: 1.0,
            compliance: 0.0,
        };
        let springs = Springs::of_list(&[spring], 10).expect("ten particles");
        let particles = ClothParticles::new(&[Vec3::ZERO; 5], &[1.0; 5]).expect("five particles");
        let _ = Solver::new(&springs, &particles);
    }

    /// Without responses.
    fn advance(
        particles: &mut ClothParticles,
        springs: &Springs,
        step: TickStep,
        pins: &[PinMotion],
    ) {
        Solver::new(springs, particles).advance(particles, step, pins, |_, _| false);
    }

    fn cloth(material: &ClothMaterial, pins: &Pins) -> (ClothParticles, Springs) {
        let grid = Cloth::new(6, 5, 0.1).grid(Vec3::ONE).expect("a sound grid");
        let mut particles = ClothParticles::at_rest(&grid, material).expect("a sound material");
        particles.weigh(&grid, material, pins).expect("sound pins");
        (particles, Springs::of_grid(&grid, material))
    }

    /// Free fall by the discrete formula: after n sub-steps a particle has fallen g Δt² n(n + 1)/2, which is
    /// ½ g t² + ½ g t Δt. The rounding of n additions to a height of h is below n ε h.
    #[test]
    fn falls_by_the_discrete_formula() {
        let (mut particles, springs) = cloth(&ClothMaterial::COTTON, &Pins::none());
        let start = particles.position(7).expect("it exists");
        let step = TickStep {
            acceleration: Vec3::new(0.0, -9.81, 0.0),
            ..Default::default()
        };
        for _ in 0..64 {
            advance(&mut particles, &springs, step, &[]);
        }
        let (time, dt, substeps) = (1.0, 1.0 / 1280.0, 1280.0);
        let expected = 0.5 * 9.81 * time * (time + dt);
        let fallen = start.y - particles.position(7).expect("it exists").y;
        let rounding = substeps * f32::EPSILON * expected;
        assert!(
            (fallen - expected).abs() < rounding,
            "{fallen} {expected} ± {rounding}"
        );
    }

    /// D is lost in each 1/60 s, whatever the sub-steps: after 1 s of a free flight the velocity is
    /// (1 − D)⁶⁰ of what it was.
    #[test]
    fn damping_is_the_same_under_any_substeps() {
        for substeps in [1, 7, 40] {
            let (mut particles, springs) = cloth(&ClothMaterial::COTTON, &Pins::none());
            for index in 0..particles.len() {
                particles.set_velocity(index, Vec3::X).expect("it exists");
            }
            let step = TickStep {
                substeps,
                damping: 0.02,
                ..Default::default()
            };
            for _ in 0..64 {
                advance(&mut particles, &springs, step, &[]);
            }
            let velocity = particles.velocity(3).expect("it exists").x;
            let expected = 0.98_f32.powi(60);
            assert!(
                (velocity / expected - 1.0).abs() < 1e-3,
                "{substeps}: {velocity} {expected}"
            );
        }
    }

    /// Inner forces come in pairs: the centre of mass of a free cloth, crumpled and shaken, stays where it is
    /// up to the rounding of each move, half an ε of a position below 1 m; 1280 × some 100 springs of moves in
    /// all, whose roundings add up as a random walk: √128,000 × 6e-8 m ≈ 2e-5 m.
    #[test]
    fn a_free_cloth_keeps_its_centre_of_mass() {
        let (mut particles, springs) = cloth(&ClothMaterial::COTTON, &Pins::none());
        for index in 0..particles.len() {
            let phase = index as f32;
            let crumpled = Vec3::new(phase.sin(), (1.7 * phase).cos(), (0.3 * phase).sin()) * 0.2;
            particles.set_position(index, crumpled).expect("it exists");
        }
        let centre = |particles: &ClothParticles| {
            let masses = particles.inverse_masses().map(f32::recip);
            let total: f32 = particles.inverse_masses().map(f32::recip).sum();
            particles
                .positions()
                .zip(masses)
                .map(|(p, m)| p * m)
                .sum::<Vec3>()
                / total
        };
        let before = centre(&particles);
        for _ in 0..64 {
            advance(&mut particles, &springs, TickStep::default(), &[]);
        }
        let drift = centre(&particles).distance(before);
        assert!(drift < 2e-5, "{drift}");
    }

    #[test]
    fn pins_are_exact_and_follow_their_motion() {
        let (mut particles, springs) = cloth(&ClothMaterial::SILK, &Pins::top_row());
        let before: Vec<Vec3> = particles.positions().take(6).collect();
        particles
            .set_velocity(2, Vec3::splat(9.0))
            .expect("it exists");
        let step = TickStep {
            acceleration: Vec3::new(3.0, -9.81, 5.0),
            ..Default::default()
        };
        for _ in 0..64 {
            advance(&mut particles, &springs, step, &[]);
        }
        assert_eq!(particles.positions().take(6).collect::<Vec<_>>(), before);

        let motion = PinMotion {
            particle: 2,
            from: before[2],
            to: before[2] + Vec3::Z,
        };
        let mut path = Vec::new();
        let mut solver = Solver::new(&springs, &particles);
        solver.advance(&mut particles, step, &[motion], |particles, substep| {
            path.push((substep.end(), particles.position(2).expect("it exists").z));
            false
        });
        assert_eq!(path.len(), 20);
        assert!(
            path.iter().all(|(end, z)| (end - z).abs() < 1e-6),
            "{path:?}"
        );
    }

    #[test]
    fn coincident_and_pinned_ends_do_no_harm() {
        let rigid = ClothMaterial {
            stretch_compliance: 0.0,
            shear_compliance: 0.0,
            ..ClothMaterial::COTTON
        };
        let (mut particles, springs) = cloth(&rigid, &Pins::filter(|row, _| row < 2));
        for index in 12..particles.len() {
            particles
                .set_position(index, Vec3::ZERO)
                .expect("it exists");
        }
        for seconds in [1.0 / 64.0, 1.0, 100.0] {
            let step = TickStep {
                seconds,
                acceleration: Vec3::NEG_Y,
                ..Default::default()
            };
            for _ in 0..64 {
                advance(&mut particles, &springs, step, &[]);
            }
            assert_eq!(particles.validate(), Ok(()), "{seconds} s a tick");
        }
    }
}
