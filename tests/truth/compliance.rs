//! Compliances mean what they say, whatever the sub-steps and the resolution.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Solver, Tethers, TickStep},
};

const GRAVITY: f32 = 9.81;
/// Length of the cloth (m), between the pins and its free end.
const LENGTH: f32 = 1.5;

/// How far the free end of a cloth at rest is below where it would be without its weight (m): `along` particles from
/// the pins to that end, hung by a row, or, sheared, by a column.
fn sag(along: u32, material: &ClothMaterial, substeps: u32, is_sheared: bool) -> f32 {
    let spacing = LENGTH / (along - 1) as f32;
    // What is sheared is square: a narrow strip would bend over its threads like a beam.
    let (columns, rows) = if is_sheared {
        (along, along)
    } else {
        (6, along)
    };
    let grid = Cloth::new(columns, rows, spacing)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let surface = Surface::of_grid(&grid);
    let mut particles = ClothParticles::at_rest(&surface, material).expect("a valid material");
    for across in 0..(columns * rows / along) {
        let pin = if is_sheared { (across, 0) } else { (0, across) };
        particles.set_inverse_mass(pin, 0.0).expect("it exists");
    }
    let springs = Springs::of_grid(&grid, material);
    let mut solver = Solver::new(&springs, &particles);
    solver.set_tethers(Tethers::new(&surface, material, &particles, GRAVITY));
    let step = TickStep {
        seconds: 1.0 / 64.0,
        substeps,
        acceleration: Vec3::new(0.0, -GRAVITY, 0.0),
        damping: material.damping,
        ..TickStep::default()
    };
    for _ in 0..64 * 10 {
        solver.advance(&mut particles, step, &[], |_, _| false);
    }
    let end = if is_sheared {
        (along / 2, along - 1)
    } else {
        (along - 1, 3)
    };
    let (row, column) = end;
    grid.rest_position(row, column).y - particles.position(end).expect("it exists").y
}

/// A column of length L stretches by α ρ g L²/2 under its weight, whatever it is cut into. A sweep leaves at most
/// F (w + w) Δt² a spring, F being the weight below it: (n − 1)² g Δt² in all.
///
/// A cloth held by its side shears by the same law: a cell's two diagonals answer a shear γ with γ/α newtons a metre,
/// which carry ρ g (L − x); so the end hangs α ρ g L²/2 low. Threads there don't stretch, so they come in by
/// their slope's square, 4 % of 4 % here. The sweeps leave as much as above once for the diagonals and once for
/// the threads.
#[test]
fn stretch_and_shear_follow_their_closed_form() {
    let compliance = 0.02;
    for is_sheared in [false, true] {
        for (along, substeps) in [(16, 20), (16, 80), (31, 40), (64, 80)] {
            let (stretch, shear) = if is_sheared {
                (0.0, compliance)
            } else {
                (compliance, f32::INFINITY)
            };
            let material = ClothMaterial {
                stretch_compliance: stretch,
                shear_compliance: shear,
                bend_rigidity: 0.0,
                damping: 0.05,
                ..ClothMaterial::COTTON
            };
            let exact = compliance * material.areal_density * GRAVITY * LENGTH * LENGTH / 2.0;
            let found = sag(along, &material, substeps, is_sheared);
            let dt = 1.0 / 64.0 / substeps as f32;
            let left = ((along - 1) as f32).powi(2) * GRAVITY * dt * dt;
            let allowed = if is_sheared {
                2.0 * left + 0.04 * exact
            } else {
                left
            };
            println!(
                "{}, {along} particles, {substeps} sub-steps: {:.2} mm, closed form {:.2} ± {:.2} mm",
                if is_sheared { "shear" } else { "stretch" },
                1.0e3 * found,
                1.0e3 * exact,
                1.0e3 * allowed
            );
            assert!(
                (found - exact).abs() < allowed,
                "{found} {exact} ± {allowed}"
            );
        }
    }
}
