//! What lasts: the energy of a swing, the momenta of a free cloth, and what a compliance means.

use bevy::math::{DVec3, Vec3};
use bevy_drape::solver::{ClothSettings, TickStep};
use examples_shared::{
    modes::{hanging_period, hanging_places, hanging_shape},
    sheet::{GRAVITY, Sheet, threads},
};

/// A rigid sheet of 64 rows, hung by the top row and swinging in its first mode, 0.1 m to either side: after a minute without
/// damping, 20 sub-steps leave nine tenths of its energy at least. Energy is twice the mean kinetic one over two periods.
#[test]
fn an_undamped_sheet_swings_for_a_minute() {
    let (rows, length) = (64, 2.0);
    let spacing = length / f64::from(rows - 1);
    let shape = hanging_shape(rows, 0);
    let places = hanging_places(&vec![spacing; shape.len() - 1], &shape, 0.1);
    let mut sheet = Sheet::new(
        (8, rows),
        spacing as f32,
        threads(0.0, 0.0),
        TickStep::default(),
        |row, column| {
            let [y, z] = places[row as usize];
            Vec3::new(spacing as f32 * column as f32, y as f32, z as f32)
        },
        |row, _| row == 0,
    )
    .tethered(ClothSettings::default().tethers);
    let window = (2.0 * hanging_period(length, 0) * 64.0).round() as u32;
    let mut mean_kinetic = || {
        let each = (0..window).map(|_| {
            sheet.tick(|_, _| {});
            sheet.energy()[0]
        });
        each.sum::<f64>() / f64::from(window)
    };
    let first = mean_kinetic();
    let mut last = first;
    for _ in 1..64 * 60 / window {
        last = mean_kinetic();
    }
    println!(
        "undamped swing: {:.1} % of its energy left after a minute",
        100.0 * last / first
    );
    assert!(last / first > 0.9 && last / first < 1.01, "{first} {last}");
}

/// A crumpled cloth that flies, spins and shakes: its momentum changes by its weight alone, and its angular momentum about its
/// own centre not at all. 0.1 % of what the momentum becomes, 1 % of the angular one.
#[test]
fn a_free_cloth_keeps_both_momenta() {
    for (name, stretch, shear) in [("rigid", 0.0, 0.0), ("soft", 1.0e-3, 1.0e-2)] {
        let material = threads(stretch, shear);
        let at = |row: u32, column: u32| 0.1 * Vec3::new(column as f32, -(row as f32), 0.0);
        let step = TickStep::default();
        let mut sheet = Sheet::new((16, 12), 0.1, material, step, at, |_, _| false);
        let (spin, throw) = (Vec3::new(0.5, 1.0, 2.0), Vec3::new(0.5, 4.0, -1.0));
        let middle = Vec3::new(0.75, -0.55, 0.0);
        for index in 0..sheet.particles.len() {
            let place = sheet.particles.position(index).expect("it exists");
            let phase = index as f32;
            let shake = Vec3::new(phase.sin(), (1.7 * phase).cos(), (0.3 * phase).sin());
            let velocity = throw + spin.cross(place - middle) + 0.2 * shake;
            sheet
                .particles
                .set_velocity(index, velocity)
                .and_then(|()| sheet.particles.set_position(index, place + 0.005 * shake))
                .expect("it exists");
        }
        let momenta = |sheet: &Sheet| {
            let (mut mass, mut centre, mut linear) = (0.0, DVec3::ZERO, DVec3::ZERO);
            let each: Vec<(f64, DVec3, DVec3)> = (0..sheet.particles.len())
                .map(|index| {
                    let place = sheet.particles.position(index).expect("it exists");
                    let velocity = sheet.particles.velocity(index).expect("it exists");
                    (sheet.masses()[index], place.as_dvec3(), velocity.as_dvec3())
                })
                .collect();
            for (own, place, velocity) in &each {
                mass += own;
                centre += own * place;
                linear += own * velocity;
            }
            let (centre, mean) = (centre / mass, linear / mass);
            let angular = each
                .iter()
                .map(|(own, place, velocity)| own * (place - centre).cross(velocity - mean));
            (linear, angular.sum::<DVec3>(), mass)
        };
        let (linear, angular, mass) = momenta(&sheet);
        let seconds = 4.0;
        for _ in 0..64 * 4 {
            sheet.tick(|_, _| {});
        }
        let (later, turning, _) = momenta(&sheet);
        let expected = linear + DVec3::NEG_Y * (GRAVITY * mass * seconds);
        let off = later.distance(expected) / expected.length();
        let turned = turning.distance(angular) / angular.length();
        println!(
            "free flight, {name}: momentum {:.4} % off, angular momentum {:.3} % off after {seconds} s",
            100.0 * off,
            100.0 * turned
        );
        assert!(off < 1.0e-3 && turned < 1.0e-2, "{name}: {off} {turned}");
    }
}

/// How far the end of a sheet of 1.5 m hangs below where it would be without weight (m): hung by its top row, or by its left
/// column, where it is sheared and `shear` alone gives.
fn sag(along: u32, compliance: f32, is_sheared: bool, substeps: u32) -> f64 {
    let spacing = 1.5 / (along - 1) as f32;
    let mut material = if is_sheared {
        threads(0.0, compliance)
    } else {
        threads(compliance, f32::INFINITY)
    };
    material.damping = 0.05;
    let columns = if is_sheared { along } else { 6 };
    let step = TickStep {
        substeps,
        ..TickStep::default()
    };
    let place = |row: u32, column: u32| spacing * Vec3::new(column as f32, -(row as f32), 0.0);
    let mut sheet = Sheet::new(
        (columns, along),
        spacing,
        material,
        step,
        place,
        |row, column| {
            if is_sheared { column == 0 } else { row == 0 }
        },
    )
    .tethered(ClothSettings::default().tethers);
    for _ in 0..64 * 10 {
        sheet.tick(|_, _| {});
    }
    let end = if is_sheared {
        (along / 2, along - 1)
    } else {
        (along - 1, 3)
    };
    let rest = place(end.0, end.1).y;
    f64::from(rest - sheet.particles.position(end).expect("it exists").y)
}

/// A compliance means the same at any resolution and in any number of sub-steps: c ρ g L² ⁄ 2 to 2 %, stretched, and to 5 %
/// sheared, where threads that turn by 4 % of their length take a part of the weight.
#[test]
fn compliance_does_not_depend_on_resolution_and_sub_steps() {
    let compliance = 0.02_f32;
    let truth = f64::from(compliance) * 0.15 * GRAVITY * 1.5 * 1.5 / 2.0;
    let mut failures = Vec::new();
    for (is_sheared, allowed, name, rows) in [
        (false, 0.02, "stretched", [16, 64, 128]),
        (true, 0.05, "sheared", [9, 16, 32]),
    ] {
        for along in rows {
            for substeps in [10, 20, 40] {
                let ratio = sag(along, compliance, is_sheared, substeps) / truth;
                println!(
                    "{name}, {along} particles, {substeps} sub-steps: {ratio:.3} of the closed form"
                );
                if (ratio - 1.0).abs() > allowed {
                    failures.push((name, along, substeps, ratio));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}
