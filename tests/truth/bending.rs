//! Bending against closed forms: a heavy strip that is clamped, its natural frequency, and a disc that drapes.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Bending, Solver, TickStep},
};

use crate::drape::Drape;

const GRAVITY: f32 = 9.81;
/// Length of the strip (m).
const LENGTH: f32 = 0.3;

/// How far the free end of a heavy strip that is clamped level drops, in parts of its length, by Γ = w L³ ⁄ D, with its weight
/// w an area: the elastica under its own weight (Bickley 1934; Rohde 1953), integrated anew.
const DROPS: [(f32, f32); 7] = [
    (1.0, 0.1235),
    (2.0, 0.2385),
    (5.0, 0.4959),
    (10.0, 0.7002),
    (20.0, 0.8299),
    (50.0, 0.9079),
    (100.0, 0.9375),
];

/// A strip, `count` particles long, of which the first two hold its end level.
///
/// What is bent at the second particle is the slope between it and the third less that between it and the first: the curvature
/// from the middle between the first two on. So the clamp is there, and `count` particles are `count` − 1.5 spacings long.
struct Strip {
    particles: ClothParticles,
    solver: Solver,
    material: ClothMaterial,
    spacing: f32,
}

impl Strip {
    /// Of two rows, without diagonals.
    fn new(count: u32, rigidity: f32, damping: f32) -> Self {
        Self::of_rows(count, 2, rigidity, f32::INFINITY, damping)
    }

    fn of_rows(count: u32, rows: u32, rigidity: f32, shear: f32, damping: f32) -> Self {
        let spacing = LENGTH / (count as f32 - 1.5);
        let material = ClothMaterial {
            stretch_compliance: 0.0,
            shear_compliance: shear,
            bend_rigidity: rigidity,
            damping,
            ..ClothMaterial::COTTON
        };
        let grid = Cloth::new(count, rows, spacing)
            .lying()
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let surface = Surface::of_grid(&grid);
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
        for (row, column) in grid.cells() {
            if column < 2 {
                particles
                    .set_inverse_mass((row, column), 0.0)
                    .expect("it exists");
            }
        }
        let mut solver = Solver::new(&Springs::of_grid(&grid, &material), &particles);
        solver.set_bending(Bending::new(&surface, &material));
        Self {
            particles,
            solver,
            material,
            spacing,
        }
    }

    fn tick(&mut self, substeps: u32, gravity: f32) {
        let step = TickStep {
            seconds: 1.0 / 60.0,
            substeps,
            acceleration: Vec3::new(0.0, -gravity, 0.0),
            damping: self.material.damping,
            ..TickStep::default()
        };
        self.solver
            .advance(&mut self.particles, step, &[], |_, _| false);
    }

    fn end(&self) -> Vec3 {
        let column = self.particles.columns() - 1;
        self.particles.position((0, column)).expect("it exists")
    }
}

/// How stiff a strip is of which Γ is this (N·m).
fn rigidity(gamma: f32) -> f32 {
    ClothMaterial::COTTON.areal_density * GRAVITY * LENGTH.powi(3) / gamma
}

/// How far a strip's end drops at rest, in parts of its length.
fn drop(count: u32, substeps: u32, gamma: f32) -> f32 {
    settled(Strip::new(count, rigidity(gamma), 0.05), substeps)
}

fn settled(mut strip: Strip, substeps: u32) -> f32 {
    for _ in 0..60 * 8 {
        strip.tick(substeps, GRAVITY);
    }
    -strip.end().y / LENGTH
}

/// What one sweep leaves of the stretch is (n − 1)² g Δt² of a strip that hangs straight down: with it the strip is that much too
/// long, and the more so the more of it hangs. The rest is the spacing's.
#[test]
fn a_heavy_strip_drops_as_the_elastica() {
    for (count, substeps, allowed) in [
        (16, 20, 0.004),
        (16, 80, 0.004),
        (32, 80, 0.002),
        (32, 160, 0.002),
        (64, 160, 0.002),
        (64, 320, 0.001),
    ] {
        let left = (count as f32 - 1.0).powi(2) * GRAVITY / (60.0 * substeps as f32).powi(2);
        for (gamma, exact) in DROPS {
            let found = drop(count, substeps, gamma);
            println!(
                "{count} particles, {substeps} sub-steps, Γ {gamma}: {found:.4} of {exact:.4}, {:+.2} % of L; stretch leaves {:.2} %",
                100.0 * (found - exact),
                100.0 * left / LENGTH
            );
            assert!(
                (found - exact).abs() < allowed,
                "{count} {substeps} {gamma}"
            );
        }
    }
}

/// However wide it is, and however many sub-steps it has: no row hangs by another, and free edges do not curl, since Poisson's
/// ratio is 0. Diagonals of cotton's shear compliance hold the rows together. What is left is the spacing's, in proportion to its
/// square, and, in five sub-steps of 64 particles, what those leave of stretch.
#[test]
fn strips_of_any_width_drop_as_the_elastica() {
    for (count, allowed) in [(16, 0.004), (64, 0.005)] {
        for rows in [2, 3, 5, 9, 17] {
            let mut worst = 0.0_f32;
            for (gamma, exact) in [DROPS[0], DROPS[3], DROPS[6]] {
                for substeps in [5, 20, 40] {
                    let rigidity = rigidity(gamma);
                    let shear = ClothMaterial::COTTON.shear_compliance;
                    let strip = Strip::of_rows(count, rows, rigidity, shear, 0.05);
                    let off = settled(strip, substeps) - exact;
                    println!(
                        "{count} × {rows}, Γ {gamma}, {substeps} sub-steps: {:+.2} % of L",
                        100.0 * off
                    );
                    worst = worst.max(off.abs());
                }
            }
            assert!(worst < allowed, "{count} × {rows}: {worst}");
        }
    }
}

/// A cantilever's first frequency is 3.516 √(D ⁄ ρ L⁴) ⁄ 2π (Rayleigh).
#[test]
fn a_clamped_strip_rings_at_its_frequency() {
    for (count, substeps) in [(16, 40), (32, 40), (32, 160)] {
        let rigidity = 2.0e-2;
        let mut strip = Strip::new(count, rigidity, 0.0);
        for index in 0..strip.particles.len() {
            let place = strip.particles.position(index).expect("it exists");
            let bent =
                place + Vec3::Y * 0.05 * (place.x.max(strip.spacing) - strip.spacing).powi(2);
            strip
                .particles
                .set_position(index, bent)
                .expect("it exists");
        }
        let mut before = strip.end().y;
        let (mut first, mut last, mut crossings) = (0.0, 0.0, 0);
        for tick in 1..=300 {
            strip.tick(substeps, 0.0);
            let now = strip.end().y;
            if (before > 0.0) != (now > 0.0) {
                let at = (tick as f32 - now / (now - before)) / 60.0;
                if crossings == 0 {
                    first = at;
                }
                last = at;
                crossings += 1;
            }
            before = now;
        }
        let found = 0.5 * (crossings - 1) as f32 / (last - first);
        let density = strip.material.areal_density;
        let exact = 3.516 * (rigidity / (density * LENGTH.powi(4))).sqrt() / std::f32::consts::TAU;
        println!("{count} particles, {substeps} sub-steps: {found:.3} Hz of {exact:.3}");
        assert!((found / exact - 1.0).abs() < 0.03, "{found} {exact}");
    }
}

/// The drape coefficient rises with the rigidity and depends neither on the spacing (m) nor on how the mesh is turned: each is
/// within a tenth of their mean. At 3 mm it takes a minute: CI sets `BEVY_DRAPE_LONG`.
#[test]
fn a_disc_drapes_alike_whatever_its_mesh() {
    let is_long = std::env::var_os("BEVY_DRAPE_LONG").is_some();
    let spacings: &[f32] = if is_long {
        &[0.012, 0.006, 0.003]
    } else {
        &[0.012, 0.006]
    };
    let mut least = 0.0;
    for (name, material) in [
        ("cotton", ClothMaterial::COTTON),
        // As stiff as denim in bending, and nearly rigid otherwise.
        (
            "stiff",
            ClothMaterial {
                areal_density: 0.324,
                stretch_compliance: 5.0e-5,
                shear_compliance: 5.0e-4,
                bend_rigidity: 6.0e-5,
                ..ClothMaterial::COTTON
            },
        ),
    ] {
        let mut found = Vec::new();
        for &spacing in spacings {
            for degrees in [0.0, 45.0] {
                let drape = Drape {
                    spacing,
                    degrees,
                    substeps: 40,
                    seconds: 3.0,
                };
                let coefficient = drape.coefficient(&material).expect("a valid disc");
                println!(
                    "{name}, {spacing} m, {degrees}°: {:.1} %",
                    100.0 * coefficient
                );
                found.push(coefficient);
            }
        }
        let mean = found.iter().sum::<f32>() / found.len() as f32;
        println!("{name}: {:.1} % in the mean", 100.0 * mean);
        for coefficient in found {
            assert!(
                (coefficient / mean - 1.0).abs() < 0.1,
                "{name}: {coefficient} of {mean}"
            );
        }
        assert!(mean > least, "{name}");
        least = mean;
    }
}
