//! Creases against the closed form of an elastic-plastic strip, and the conservation of momentum.

use bevy::math::{DMat3, DVec3, Quat, Vec3};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Bending, ClothCreasing, Solver, TickStep, TimeOrder},
};

use crate::meshes::irregular;

/// Length and width of the strip (m).
const LENGTH: f32 = 0.2;
const WIDTH: f32 = 0.04;

const MATERIAL: ClothMaterial = ClothMaterial {
    stretch_compliance: 0.0,
    bend_rigidity: 2.0e-2,
    damping: 0.0,
    ..ClothMaterial::COTTON
};

/// A strip along x that nothing pulls at.
struct Strip {
    particles: ClothParticles,
    solver: Solver,
    rest: Vec<Vec3>,
    /// Of a grid (m).
    spacing: Option<f32>,
}

impl Strip {
    fn grid(spacing: f32, creasing: Option<ClothCreasing>) -> Self {
        let count = |side: f32| (side / spacing).round() as u32 + 1;
        let cloth = Cloth::new(count(LENGTH), count(WIDTH), spacing);
        let surface = cloth.surface(Vec3::ONE).expect("a valid grid");
        Self {
            spacing: Some(spacing),
            ..Self::new(&surface, creasing)
        }
    }

    fn mesh(spacing: f32, creasing: Option<ClothCreasing>) -> Self {
        let mesh = irregular(LENGTH, WIDTH, spacing, 0.2);
        let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
        Self::new(&surface, creasing)
    }

    fn new(surface: &Surface, creasing: Option<ClothCreasing>) -> Self {
        let particles = ClothParticles::at_rest(surface, &MATERIAL).expect("a valid material");
        let springs = Springs::of_surface(surface, &MATERIAL);
        let mut solver = Solver::of_surface(surface, &springs);
        let mut bending = Bending::new(surface, &MATERIAL).expect("it resists");
        bending.set_creasing(surface, &MATERIAL, creasing);
        solver.set_bending(Some(bending));
        Self {
            rest: surface.rest_positions().to_vec(),
            particles,
            solver,
            spacing: None,
        }
    }

    fn tick(&mut self, damping: f32) {
        let step = TickStep {
            seconds: 1.0 / 60.0,
            substeps: 20,
            acceleration: Vec3::ZERO,
            damping,
            order: if damping == 1.0 {
                TimeOrder::First
            } else {
                TimeOrder::Second
            },
            ..TickStep::default()
        };
        self.solver
            .advance(&mut self.particles, step, &[], |_, _| false);
    }

    /// Puts it on a cylinder of this curvature (1/m), turned.
    fn bend(&mut self, curvature: f32, turn: Quat) {
        for (index, rest) in self.rest.iter().enumerate() {
            // The chords of a grid keep their length. Its curvature is exact then.
            let angle = match self.spacing {
                Some(spacing) => rest.x / spacing * 2.0 * (0.5 * spacing * curvature).asin(),
                None => rest.x * curvature,
            };
            let (sin, cos) = angle.sin_cos();
            let bent = Vec3::new(sin / curvature, rest.y, (1.0 - cos) / curvature);
            let still = Vec3::ZERO;
            let particles = &mut self.particles;
            particles
                .set_position(index, turn * bent)
                .expect("it exists");
            particles.set_displacement(index, still).expect("it exists");
        }
    }

    /// Bends it for a tick, and lets it spring back slowly.
    fn bend_and_release(&mut self, curvature: f32) {
        let masses: Vec<f32> = self.particles.inverse_masses().collect();
        self.bend(curvature, Quat::IDENTITY);
        for index in 0..masses.len() {
            self.particles
                .set_inverse_mass(index, 0.0)
                .expect("it exists");
        }
        self.tick(1.0);
        for (index, mass) in masses.into_iter().enumerate() {
            self.particles
                .set_inverse_mass(index, mass)
                .expect("it exists");
        }
        self.settle();
    }

    fn settle(&mut self) {
        for _ in 0..600 {
            self.tick(1.0);
        }
    }

    /// The curvature of the circle through its cross-section, by least squares (Kåsa 1976), after `turn` (1/m).
    fn curvature(&self, turn: Quat) -> f64 {
        let back = turn.inverse();
        let places: Vec<DVec3> = self
            .particles
            .positions()
            .map(|place| (back * place).as_dvec3())
            .collect();
        let middle = places.iter().sum::<DVec3>() / places.len() as f64;
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for place in places {
            let (x, z) = (place.x - middle.x, place.z - middle.z);
            let row = DVec3::new(2.0 * x, 2.0 * z, 1.0);
            matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
            right += row * (x * x + z * z);
        }
        // A straight strip has no circle.
        let solution = matrix.inverse() * right;
        1.0 / (solution.z + solution.x.powi(2) + solution.y.powi(2)).sqrt()
    }
}

fn creasing(yield_curvature: f32, hardening: f32) -> ClothCreasing {
    ClothCreasing {
        yield_curvature,
        hardening,
    }
}

/// A strip that is bent to κ has the moment `M = D (κ_y + h (κ − κ_y))`. Without it, it springs back by M ⁄ D: it keeps
/// `(1 − h) (κ − κ_y)`, or, as it yields again on its way back, κ_y (1 − h) ⁄ h.
#[test]
fn a_strip_springs_back_as_the_closed_form_says() {
    for hardening in [0.0, 0.3, 0.8] {
        let creasing = creasing(10.0, hardening);
        for curvature in [15.0_f32, 25.0, 40.0] {
            let left = (1.0 - hardening) * (curvature - creasing.yield_curvature);
            let exact = f64::from(left.min(creasing.largest_crease()));
            for spacing in [0.02, 0.01, 0.005] {
                for (name, mut strip) in [
                    ("grid", Strip::grid(spacing, Some(creasing))),
                    ("mesh", Strip::mesh(spacing, Some(creasing))),
                ] {
                    strip.bend_and_release(curvature);
                    let found = strip.curvature(Quat::IDENTITY);
                    println!(
                        "{name} {spacing} m, h {hardening}, {curvature}/m: {found:.3} of {exact:.3}/m, {:+.2} %",
                        100.0 * (found / exact - 1.0)
                    );
                }
            }
        }
    }
}
