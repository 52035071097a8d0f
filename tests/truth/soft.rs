//! Soft cloths, which forces move: as exact as f64, and with the energy that they began with.

use bevy::math::Vec3;
use bevy_drape::{cloth::ClothMaterial, solver::TickStep};
use examples_shared::{
    sheet::{GRAVITY, Sheet, threads},
    smooth::Smooth,
};

/// A 64² of 1 mm/N that falls, half a second on, in as few sub-steps as forces need, against the same springs in f64: to 0.02 mm.
/// What is left of the step's square is 10⁻³ mm; positions of up to 2 m are rounded by 6·10⁻⁵ mm in each of 2,760 sub-steps, which
/// adds up to 3·10⁻³ mm if each particle wanders by itself, and to more along its modes.
#[test]
fn a_soft_cloth_moves_as_in_f64() {
    for (name, substeps) in [("fall, 32²", 46), ("fall, 64²", 92)] {
        let motion = Smooth::ALL.iter().find(|motion| motion.name == name);
        let motion = motion.expect("it is among them");
        let (reference, apart) = motion.reference();
        let error = |by_forces: bool| {
            let step = TickStep {
                substeps,
                ..TickStep::default()
            };
            motion
                .error(step, by_forces, &reference)
                .expect("short sub-steps")
        };
        let (forces, threads) = (error(true), error(false));
        println!(
            "{name}: {forces:.2e} m by forces, {threads:.2e} m by threads; reference {apart:.0e} m"
        );
        assert!(forces < 2.0e-5, "{name}: {forces}");
        // It is the forces that did it.
        assert!(threads > 3.0 * forces, "{name}: {threads}");
    }
}

/// Kinetic energy, and what weight and springs hold of it (J).
fn energy(sheet: &Sheet) -> f64 {
    let places: Vec<_> = sheet.particles.positions().map(Vec3::as_dvec3).collect();
    let masses = sheet.masses();
    let moved = (0..places.len()).map(|at| {
        let velocity = sheet.particles.velocity(at).expect("it exists").as_dvec3();
        masses[at] * (0.5 * velocity.length_squared() + GRAVITY * places[at].y)
    });
    let held = sheet.springs.iter().map(|spring| {
        let [a, b] = spring.ends.map(|end| places[end as usize]);
        let longer = a.distance(b) - f64::from(spring.rest_length);
        0.5 * longer * longer / f64::from(spring.compliance)
    });
    moved.sum::<f64>() + held.sum::<f64>()
}

/// Let go with its springs at rest and hung by two corners, rubber falls, stretches by more than half and throws itself about for a
/// minute. Undamped, and of all that its weight can do, it gains no more than 0.2 % and loses no more than 2 %: what a symplectic
/// method keeps is not quite the energy. The two differ by up to (ω Δt)² ⁄ 8 of what is in a swing of ω, a fifth of what is in the
/// fastest, and four times less with twice the sub-steps (12²: 1.5, 0.4, 0.1 % were found with 5, 10 and 20).
#[test]
fn rubber_keeps_its_energy_for_a_minute() {
    let rubber = ClothMaterial::RUBBER;
    let material = ClothMaterial {
        areal_density: rubber.areal_density,
        ..threads(rubber.stretch_compliance, rubber.shear_compliance)
    };
    for side in [12_u32, 24] {
        let spacing = 1.5 / (side - 1) as f32;
        let place = |row: u32, column: u32| spacing * Vec3::new(column as f32, 0.0, row as f32);
        let is_corner = |row, column| row == 0 && (column == 0 || column == side - 1);
        let step = TickStep::default();
        let mut sheet = Sheet::new((side, side), spacing, material, step, place, is_corner);
        let needed = sheet
            .solver
            .needed(&sheet.particles, side as usize, step.seconds, step.order);
        sheet.step.substeps = needed;
        let weight = sheet.masses().iter().sum::<f64>() * GRAVITY;
        let scale = 1.5 * weight;
        let begin = energy(&sheet);
        let (mut lost, mut gained) = (0.0_f64, 0.0_f64);
        for _ in 0..60 * 64 {
            sheet.tick(|_, _| {});
            let gain = (energy(&sheet) - begin) / scale;
            (lost, gained) = (lost.max(-gain), gained.max(gain));
        }
        println!("{side}²: {needed} sub-steps, loses {lost:.1e} and gains {gained:.1e}");
        assert!(lost < 0.02 && gained < 0.002, "{side}²: {lost} {gained}");
    }
}
