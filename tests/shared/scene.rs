//! Cloths hung and let go, ready to be stepped: for tests, benchmarks, and the lab.

use bevy::math::Vec3;

use bevy_drape::{
    cloth::{Cloth, ClothError, ClothGrid, ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Bending, Solver, Tethers, TickStep},
};

/// Standard gravity (m/s²), along −y.
pub const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// A cloth, its initial state, and the forces on it.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The grid of its particles.
    pub grid: ClothGrid,
    /// Its material.
    pub material: ClothMaterial,
    /// The surface of the grid.
    pub surface: Surface,
    /// Its particles at the start; some are pinned.
    pub particles: ClothParticles,
    /// The springs between them.
    pub springs: Springs,
    /// Acceleration (m/s²).
    pub acceleration: Vec3,
    /// Length of a tick (s).
    pub seconds: f32,
}

impl Scene {
    /// A square cloth of `side`² particles, `width` m wide: horizontal, and hung by two corners of one edge. It has
    /// rigid structural and shear springs and no bending, loses 1 % of its velocity a second, and runs at 60 ticks a
    /// second.
    ///
    /// # Errors
    /// [`ClothError`] if the cloth can't be built.
    pub fn hung_by_corners(side: u32, width: f32) -> Result<Self, ClothError> {
        let material = ClothMaterial {
            areal_density: 0.15,
            stretch_compliance: 0.0,
            shear_compliance: 0.0,
            bend_rigidity: 0.0,
            weft: None,
            stiffening: None,
            stretch_damping: 0.0,
            damping: 1.0 - 0.99_f32.powf(1.0 / 60.0),
            friction: 0.0,
        };
        let mut scene = Self::square(side, width, material, |down| Vec3::Z * down)?;
        for corner in [0, side - 1] {
            scene.particles.set_inverse_mass((0, corner), 0.0)?;
        }
        Ok(scene)
    }

    /// A square cloth of `side`² particles, `width` m wide: hung by its top row, and released `angle` rad from the
    /// vertical. It has structural and shear springs of `compliance` (m/N) and no bending, is undamped, and runs at 60
    /// ticks a second.
    ///
    /// # Errors
    /// [`ClothError`] if the cloth can't be built.
    pub fn swinging(
        side: u32,
        width: f32,
        angle: f32,
        compliance: f32,
    ) -> Result<Self, ClothError> {
        let material = ClothMaterial {
            areal_density: 0.15,
            stretch_compliance: compliance,
            shear_compliance: compliance,
            bend_rigidity: 0.0,
            weft: None,
            stiffening: None,
            stretch_damping: 0.0,
            damping: 0.0,
            friction: 0.0,
        };
        let down = Vec3::new(0.0, -angle.cos(), angle.sin());
        let mut scene = Self::square(side, width, material, |along| down * along)?;
        for column in 0..side {
            scene.particles.set_inverse_mass((0, column), 0.0)?;
        }
        Ok(scene)
    }

    fn square(
        side: u32,
        width: f32,
        material: ClothMaterial,
        place: impl Fn(f32) -> Vec3,
    ) -> Result<Self, ClothError> {
        let spacing = width / side.saturating_sub(1).max(1) as f32;
        let grid = Cloth::new(side, side, spacing).grid(Vec3::ONE)?;
        let surface = Surface::of_grid(&grid);
        let mut particles = ClothParticles::at_rest(&surface, &material)?;
        for (row, column) in grid.cells() {
            let rest = grid.rest_position(row, column);
            let position = Vec3::X * rest.x + place(-rest.y);
            particles.set_position((row, column), position)?;
        }
        Ok(Self {
            springs: Springs::of_grid(&grid, &material),
            grid,
            surface,
            material,
            particles,
            acceleration: GRAVITY,
            seconds: 1.0 / 60.0,
        })
    }

    /// The library's solver for it, on one thread.
    pub fn solver(&self, with_tethers: bool) -> Solver {
        let mut solver = Solver::new(&self.springs, &self.particles);
        solver.set_bending(Bending::new(&self.surface, &self.material));
        if with_tethers {
            solver.set_tethers(Tethers::new(
                &self.surface,
                &self.material,
                &self.particles,
                self.acceleration.length(),
            ));
        }
        solver
    }

    /// A tick of it in this many sub-steps.
    pub fn step(&self, substeps: u32) -> TickStep {
        TickStep {
            seconds: self.seconds,
            substeps,
            acceleration: self.acceleration,
            damping: self.material.damping,
            ..TickStep::default()
        }
    }
}
