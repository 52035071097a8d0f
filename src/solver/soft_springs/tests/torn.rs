//! Grids that are torn and mapped: their forces in f64, and what forces and chains conserve.

use std::sync::Arc;

use bevy::math::{DVec3, Vec3};

use super::{SOFT, Twin, grid, step};
use crate::{
    cloth::{ClothMaterial, ClothParticles, ClothTears, Springs, StiffnessFactors, Surface},
    solver::{bending::Bending, step::TickStep, substep::Solver},
};

/// A grid that is cut along half of a row and up a column, and has a face out. Its particles have factors of stiffness between a half and
/// one.
fn torn(columns: u32, rows: u32) -> (Surface, StiffnessFactors) {
    let whole = Arc::new(Surface::of_grid(&grid(columns, rows)));
    let mut tears = ClothTears::default();
    let at = |row: u32, column: u32| row * columns + column;
    let (row, column) = (rows / 2, columns / 2);
    tears.tear_all((0..column).map(|of| [at(row, of), at(row, of + 1)]));
    tears.tear_all((0..row).map(|of| [at(of, column), at(of + 1, column)]));
    tears.tear_out(&whole, whole.triangles()[whole.triangles().len() - 2]);
    let surface = whole.torn(tears.edges()).expect("edges of the grid");
    assert!(surface.len() > whole.len());
    let factor = |at: usize| 0.75 + 0.25 * (at as f32).sin();
    let factors = StiffnessFactors {
        stretch: (0..surface.len()).map(factor).collect(),
        ..StiffnessFactors::default()
    };
    (surface, factors)
}

/// The same of it, crumpled: particles, springs and solver.
pub fn crumpled_and_torn(
    columns: u32,
    rows: u32,
    material: &ClothMaterial,
    noise: f32,
) -> (ClothParticles, Springs, Solver) {
    let (surface, factors) = torn(columns, rows);
    let springs = Springs::with_factors(&surface, material, &factors);
    let mut particles = ClothParticles::at_rest(&surface, material).expect("a valid material");
    for (index, place) in surface.rest_positions().iter().enumerate() {
        let at = index as f32;
        let noise = noise * Vec3::new(at.sin(), (2.0 * at).cos(), (3.0 * at).sin());
        particles
            .set_position(index, *place + noise)
            .and_then(|()| particles.set_velocity(index, 20.0 * noise))
            .expect("it exists");
    }
    particles.set_inverse_mass(0, 0.0).expect("it exists");
    let mut solver = Solver::of_surface(&surface, &springs);
    solver.set_bending(Bending::new(&surface, material));
    (particles, springs, solver)
}

/// A torn and mapped grid has the forces of its springs, too. They are up to a tenth too long, where a force is off by 4·10⁻⁶ of itself, a
/// hundredth of that above. Corners of a face alone have a third of the mass of a grid's corner: so a hundredth of three times as much is
/// allowed, and the rounding of places, 2⁻²³ of 8 m. They swing faster, too: 120 sub-steps.
#[test]
fn a_tick_of_a_torn_grid_is_that_of_a_plain_solver_in_f64() {
    for (columns, rows) in [(4, 4), (5, 7), (16, 9), (33, 6), (70, 5)] {
        let (mut particles, springs, mut solver) = crumpled_and_torn(columns, rows, &SOFT, 0.005);
        let mut twin = Twin::of(&particles, &springs);
        let step = step(120);
        assert!(solver.is_explicit(&particles, &step));
        solver.advance(&mut particles, step, &[], |_, _| false);
        twin.tick(&step);
        let apart = particles.positions().zip(&twin.places);
        let apart = apart.map(|(ours, its)| ours.as_dvec3().distance(*its));
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 4.0e-6, "{columns} × {rows}: {apart}");
    }
}

/// The energy of motion and of springs (J).
fn energy(particles: &ClothParticles, springs: &Springs) -> f64 {
    let motion = (0..particles.len()).map(|at| {
        let speed = particles.velocity(at).expect("it exists").as_dvec3();
        let inverse_mass = f64::from(particles.inverse_mass(at).expect("it exists"));
        match inverse_mass > 0.0 {
            true => 0.5 * speed.length_squared() / inverse_mass,
            false => 0.0,
        }
    });
    let held = springs.to_vec().into_iter().map(|spring| {
        let [a, b] = spring
            .ends
            .map(|end| particles.position(end as usize).expect("it exists"));
        let longer = f64::from(a.distance(b) - spring.rest_length);
        0.5 * longer * longer / f64::from(spring.compliance)
    });
    motion.sum::<f64>() + held.sum::<f64>()
}

/// A torn and mapped sheet that bends in one of four sub-steps, crumpled and without damping, gains no energy in 20 s, by forces or by chains.
/// Springs alone keep it to a ripple; bending takes up what folds hold, and gives it back. So a tenth more is allowed.
#[test]
fn a_torn_grid_gains_no_energy() {
    let soft = ClothMaterial {
        bend_rigidity: 1.0e-7,
        ..SOFT
    };
    let stiff = ClothMaterial {
        stretch_compliance: 1.0e-6,
        shear_compliance: 2.0e-6,
        ..soft
    };
    for (material, substeps) in [(soft, 120), (stiff, 30)] {
        let (mut particles, springs, mut solver) = crumpled_and_torn(20, 14, &material, 0.02);
        let step = TickStep {
            acceleration: Vec3::ZERO,
            ..step(substeps)
        };
        assert_eq!(solver.is_explicit(&particles, &step), substeps == 120);
        let start = energy(&particles, &springs);
        let mut most = 0.0_f64;
        for _ in 0..20 * 64 {
            solver.advance(&mut particles, step, &[], |_, _| false);
            most = most.max(energy(&particles, &springs));
        }
        assert!(most < 1.1 * start, "{most} J of {start} J");
    }
}

/// A free torn sheet keeps its momentum, whether chains or forces move it: each spring moves both of its ends. In 64 ticks, 2,000
/// sub-steps round each of them by 2⁻²⁴.
#[test]
fn a_free_torn_grid_keeps_its_momentum() {
    for (material, substeps) in [(SOFT, 120), (ClothMaterial::COTTON, 30)] {
        let material = ClothMaterial {
            damping: 0.0,
            ..material
        };
        let (mut particles, _, mut solver) = crumpled_and_torn(20, 14, &material, 0.02);
        let mass = 0.15 * 0.1 * 0.12 / 4.0;
        particles
            .set_inverse_mass(0, 1.0 / mass)
            .expect("it exists");
        let step = TickStep {
            acceleration: Vec3::ZERO,
            ..step(substeps)
        };
        let momentum = |particles: &ClothParticles| {
            (0..particles.len()).fold((DVec3::ZERO, 0.0), |(sum, all), at| {
                let speed = particles.velocity(at).expect("it exists").as_dvec3();
                let inverse_mass = f64::from(particles.inverse_mass(at).expect("it exists"));
                (
                    sum + speed / inverse_mass,
                    all + speed.length() / inverse_mass,
                )
            })
        };
        solver.advance(&mut particles, step, &[], |_, _| false);
        let (start, all) = momentum(&particles);
        for _ in 0..64 {
            solver.advance(&mut particles, step, &[], |_, _| false);
        }
        let (end, _) = momentum(&particles);
        let allowed = 64.0 * f64::from(substeps) * 0.5_f64.powi(24) * all;
        assert!(end.distance(start) < allowed, "{start} {end} {allowed}");
    }
}
