//! A rectangular sheet that the solver moves by itself, for the lab and for tests: no app, no colliders.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothGrid, ClothMaterial, ClothParticles, Spring, Springs, Surface},
    solver::{Bending, Solver, Stretch, SubStep, Tethers, TickStep},
};

/// Standard gravity (m/s²), along −y.
pub const GRAVITY: f64 = 9.81;

/// Nothing but threads: a material of these compliances along rows and columns and along both diagonals (m/N; infinite for
/// no diagonals), 0.15 kg/m², without bending, damping or friction.
pub fn threads(stretch: f32, shear: f32) -> ClothMaterial {
    ClothMaterial {
        areal_density: 0.15,
        stretch_compliance: stretch,
        shear_compliance: shear,
        bend_rigidity: 0.0,
        weft: None,
        stiffening: None,
        stretch_damping: 0.0,
        damping: 0.0,
        friction: 0.0,
    }
}

/// The sheet, its springs and its solver.
pub struct Sheet {
    pub surface: Surface,
    pub material: ClothMaterial,
    pub particles: ClothParticles,
    pub springs: Vec<Spring>,
    pub solver: Solver,
    pub step: TickStep,
    /// Of each particle (kg), 0 for pinned ones.
    masses: Vec<f64>,
}

impl Sheet {
    /// Of `columns` × `rows` particles, `spacing` m apart; each is `placed` (m) by its row and column, and held where it is
    /// `pinned`. Gravity and the material's damping are set in `step`, whatever they are there.
    ///
    /// # Panics
    /// If there is no such cloth.
    pub fn new(
        (columns, rows): (u32, u32),
        spacing: f32,
        material: ClothMaterial,
        step: TickStep,
        placed: impl Fn(u32, u32) -> Vec3,
        pinned: impl Fn(u32, u32) -> bool,
    ) -> Self {
        let grid = Cloth::new(columns, rows, spacing)
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let cell = |index: usize| (index as u32 / columns, index as u32 % columns);
        Self::of_surface(
            Surface::of_grid(&grid),
            material,
            step,
            |index| {
                let (row, column) = cell(index);
                placed(row, column)
            },
            |index| {
                let (row, column) = cell(index);
                pinned(row, column)
            },
        )
    }

    /// The same of any surface, by the particles' indices.
    ///
    /// # Panics
    /// If there is no such cloth.
    pub fn of_surface(
        surface: Surface,
        material: ClothMaterial,
        step: TickStep,
        placed: impl Fn(usize) -> Vec3,
        pinned: impl Fn(usize) -> bool,
    ) -> Self {
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
        for index in 0..surface.len() {
            let is_there = particles.set_position(index, placed(index));
            is_there.expect("it exists");
            if pinned(index) {
                let is_there = particles.set_inverse_mass(index, 0.0);
                is_there.expect("it exists");
            }
        }
        let springs = Springs::of_surface(&surface, &material);
        let mass = |inverse: f32| {
            if inverse > 0.0 {
                1.0 / f64::from(inverse)
            } else {
                0.0
            }
        };
        let mut solver = Solver::of_surface(&surface, &springs);
        solver.set_bending(Bending::new(&surface, &material));
        solver.set_stretch_damping(material.stretch_damping);
        Self {
            solver,
            masses: particles.inverse_masses().map(mass).collect(),
            springs: springs.to_vec(),
            surface,
            material,
            particles,
            step: TickStep {
                acceleration: Vec3::NEG_Y * GRAVITY as f32,
                damping: material.damping,
                ..step
            },
        }
    }

    /// The grid that it is made of.
    ///
    /// # Panics
    /// If it is a mesh.
    pub fn grid(&self) -> &ClothGrid {
        self.surface.as_grid().expect("a grid")
    }

    /// With tethers from now on, or without.
    pub fn tethered(mut self, with: bool) -> Self {
        if with {
            let gravity = GRAVITY as f32;
            let tethers = Tethers::new(&self.surface, &self.material, &self.particles, gravity);
            self.solver.set_tethers(tethers);
        }
        self
    }

    /// A tick. `see` looks at the particles at the end of each sub-step.
    pub fn tick(&mut self, mut see: impl FnMut(&ClothParticles, SubStep)) -> Stretch {
        let (particles, step) = (&mut self.particles, self.step);
        self.solver.advance(particles, step, &[], |particles, at| {
            see(particles, at);
            false
        })
    }

    /// Mass of each particle (kg), 0 for pinned ones.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// What its weight can do at most (J): no particle comes to hang lower below its nearest pin than it is from it now.
    pub fn fall(&self) -> f64 {
        let places: Vec<Vec3> = self.particles.positions().collect();
        let each = || self.masses.iter().zip(&places);
        let pins: Vec<Vec3> = each()
            .filter(|(mass, _)| **mass == 0.0)
            .map(|(_, place)| *place)
            .collect();
        each()
            .map(|(mass, place)| {
                let nearest = pins.iter().map(|pin| pin.distance(*place));
                mass * GRAVITY * f64::from(nearest.fold(f32::INFINITY, f32::min))
            })
            .sum()
    }

    /// Kinetic, and kinetic and potential energy together (J), the potential being 0 at the origin's height. What springs hold is
    /// left out: where they are stiff it is mostly what the solver leaves of them. Of a sheet that begins with its springs at
    /// their rest lengths the sum never exceeds what it begins with.
    ///
    /// A displacement is a velocity half a sub-step ago, so positions are taken there as well: what is left of the
    /// difference is of second order in the sub-step.
    pub fn energy(&self) -> [f64; 2] {
        let each = self
            .particles
            .positions()
            .zip(self.particles.displacements());
        let (mut kinetic, mut potential) = (0.0, 0.0);
        for (index, (position, moved)) in each.enumerate() {
            let velocity = self.particles.velocity(index).expect("it exists");
            let height = f64::from(position.y) - 0.5 * f64::from(moved.y);
            kinetic += 0.5 * self.masses[index] * velocity.as_dvec3().length_squared();
            potential += self.masses[index] * GRAVITY * height;
        }
        [kinetic, kinetic + potential]
    }
}
