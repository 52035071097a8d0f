//! A strip and a square of cotton, each as long as the distance between what holds its ends, as they come to rest with what is
//! set by default.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::ClothMaterial,
    solver::{Rest, RestRule, Substepping, TickStep},
};
use examples_shared::sheet::{GRAVITY, Sheet};

/// Between both ends (m).
const SPAN: f32 = 2.0;

/// Where it is to be asleep (s): its bounces, of about 2 Hz, fade by the part 0.01 in 1/60 s.
const PATIENCE: f32 = 30.0;

/// How far the middle sags (m): an arc of sag f is longer than its span by the part ε = (8 ⁄ 3) (f ⁄ L)² and pulled by
/// T = E ε = ρ g L² ⁄ 8 f, so that f = ∛(3 ρ g L⁴ ⁄ 64 E). Threads k₁ and diagonals k₂ are a lattice of C₁₁ = k₁ + k₂ and C₁₂ = k₂:
/// E is C₁₁ where its width is held, and C₁₁ − C₁₂² ⁄ C₁₁ where it is free, 0.8 % less.
fn sag(material: &ClothMaterial) -> f64 {
    let [threads, diagonals] = [material.stretch_compliance, material.shear_compliance]
        .map(|compliance| 1.0 / f64::from(compliance));
    let along = threads + diagonals;
    let stiffness = along - 0.5 * diagonals * diagonals / along;
    let weight = f64::from(material.areal_density) * GRAVITY;
    (3.0 * weight * f64::from(SPAN).powi(4) / (64.0 * stiffness)).cbrt()
}

/// In the mean of its last second to 3 % of 46.5 mm, and where it sleeps to 5 %.
#[test]
fn strips_and_awnings_sag_by_what_they_give_and_sleep() {
    let material = ClothMaterial::COTTON;
    let truth = sag(&material);
    assert!((truth - 0.0466).abs() < 0.0001, "{truth}");
    for (name, columns, rows) in [
        ("strip", 33_u32, 2_u32),
        ("strip", 65, 2),
        ("awning", 17, 17),
        ("awning", 33, 33),
    ] {
        let spacing = SPAN / (columns - 1) as f32;
        let tick = TickStep::default();
        let step = TickStep {
            substeps: Substepping::needed(columns as usize, tick.seconds),
            ..tick
        };
        let place = |row: u32, column: u32| spacing * Vec3::new(column as f32, 0.0, row as f32);
        let is_held = |_, column| column == 0 || column == columns - 1;
        let mut sheet = Sheet::new((columns, rows), spacing, material, step, place, is_held);
        let diagonal = spacing * ((columns - 1) as f32).hypot((rows - 1) as f32);
        let mut rest = Rest::default();
        let mut sags = Vec::new();
        let mut passed = 0.0;
        while !rest.is_asleep() && passed < PATIENCE {
            sheet.tick(|_, _| {});
            rest.observe(
                step.seconds,
                &sheet.particles,
                (diagonal, GRAVITY as f32),
                RestRule::Free,
            );
            passed += step.seconds;
            let middle = sheet.particles.position((rows / 2, columns / 2));
            sags.push(-f64::from(middle.expect("it exists").y));
        }
        // Two bounces, of which it sleeps with what is left.
        let last = &sags[sags.len().saturating_sub(64)..];
        let found = last.iter().sum::<f64>() / last.len() as f64;
        let asleep = last[last.len() - 1];
        println!(
            "{name}, {columns} × {rows}, {} sub-steps: {:.1} mm of {:.1}, {:+.1} %; {:.1} mm asleep, after {passed:.1} s",
            step.substeps,
            1.0e3 * found,
            1.0e3 * truth,
            100.0 * (found / truth - 1.0),
            1.0e3 * asleep
        );
        assert!(rest.is_asleep(), "{name} {columns}");
        assert!(
            (found / truth - 1.0).abs() < 0.03,
            "{name} {columns}: {found}"
        );
    }
}
