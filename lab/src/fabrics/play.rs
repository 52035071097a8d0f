//! A surface that moves at default settings.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Bending, Control, Solver, Substepping, TickStep},
};
use examples_shared::sheet::GRAVITY;

/// A surface, its particles and its automatic sub-steps.
pub struct Play {
    pub rest: Vec<Vec3>,
    pub particles: ClothParticles,
    solver: Solver,
    step: TickStep,
    control: Control,
    needed: u32,
    /// Seconds since it began.
    time: f64,
}

impl Play {
    /// Particles at `place` of where they rest, those of `is_pinned` held, in ticks of 1/64 s. `along` is the number of particles
    /// along its longer side.
    pub fn new(
        surface: &Surface,
        material: &ClothMaterial,
        along: u32,
        place: impl Fn(Vec3) -> Vec3,
        is_pinned: impl Fn(Vec3) -> bool,
    ) -> Self {
        let mut particles = ClothParticles::at_rest(surface, material).expect("a valid material");
        let rest = surface.rest_positions().to_vec();
        for (index, at) in rest.iter().enumerate() {
            particles
                .set_position(index, place(*at))
                .expect("it exists");
            if is_pinned(*at) {
                particles.set_inverse_mass(index, 0.0).expect("it exists");
            }
        }
        let springs = Springs::of_surface(surface, material);
        let mut solver = Solver::of_surface(surface, &springs);
        solver.set_bending(Bending::new(surface, material));
        let step = TickStep {
            seconds: 1.0 / 64.0,
            acceleration: Vec3::NEG_Y * GRAVITY as f32,
            damping: material.damping,
            ..TickStep::default()
        };
        let needed = solver.needed(&particles, along as usize, step.seconds, step.order);
        Self {
            rest,
            particles,
            solver,
            step,
            control: Control::default(),
            needed,
            time: 0.0,
        }
    }

    /// One tick; calls `see` after each sub-step, with the time (s).
    pub fn tick(&mut self, mut see: impl FnMut(&ClothParticles, f64)) {
        let method = Substepping::Automatic;
        self.step.substeps = self.control.substeps(method, self.needed);
        let length = f64::from(self.step.seconds) / f64::from(self.step.substeps);
        let mut time = self.time;
        let stretch = self
            .solver
            .advance(&mut self.particles, self.step, &[], |particles, _| {
                time += length;
                see(particles, time);
                false
            });
        self.control.observe(method, stretch);
        self.time += f64::from(self.step.seconds);
    }

    /// Ticks until it hangs still.
    pub fn settle(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick(|_, _| {});
        }
    }

    /// The mean height over the particles for which `is_meant` holds of where they rest (m).
    pub fn height(&self, is_meant: impl Fn(Vec3) -> bool) -> f64 {
        let heights = self.rest.iter().zip(self.particles.positions());
        let heights: Vec<f64> = heights
            .filter(|(rest, _)| is_meant(**rest))
            .map(|(_, place)| place.y.into())
            .collect();
        heights.iter().sum::<f64>() / heights.len() as f64
    }

    /// The period (s) of a motion across its plane of this shape, over ten zeros; infinite if it has fewer than three within twenty
    /// times the `expected` one.
    pub fn period(&mut self, shape: &[f64], expected: f64) -> f64 {
        let masses = self.particles.inverse_masses();
        let weights: Vec<f64> = masses
            .zip(shape)
            .map(|(inverse, shape)| {
                if inverse > 0.0 {
                    shape / f64::from(inverse)
                } else {
                    0.0
                }
            })
            .collect();
        let part = |particles: &ClothParticles| -> f64 {
            let places = particles.positions().zip(&weights);
            places.map(|(at, weight)| f64::from(at.z) * weight).sum()
        };
        let mut before = (0.0, part(&self.particles));
        let mut zeros = Vec::new();
        while self.time < 20.0 * expected + 1.0 && zeros.len() <= 10 {
            self.tick(|particles, time| {
                let now = (time, part(particles));
                if before.1.signum() != now.1.signum() {
                    zeros.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
                }
                before = now;
            });
        }
        match zeros[..] {
            [first, _, .., last] => 2.0 * (last - first) / (zeros.len() - 1) as f64,
            _ => f64::INFINITY,
        }
    }
}
