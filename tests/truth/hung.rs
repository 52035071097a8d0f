//! Large cloths that hang by few pins: no spring of a row or column is left longer than the solver's limit.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{ClothMaterial, SpringKind},
    solver::{PinMotion, Substepping, TickStep},
};
use examples_shared::sheet::{Sheet, threads};

const SECONDS: f32 = 1.0 / 60.0;
const WIDTH: f32 = 2.0;

/// What the solver leaves of a row or column at most, 0.5 %, and a rounding of 1.2·10⁻⁷ of 2 m at either end of a spring of
/// 32 mm: 10⁻⁵.
const LEFT: f64 = 0.005 + 1.0e-5;

/// From lying flat at rest.
fn flat(
    (columns, rows): (u32, u32),
    material: ClothMaterial,
    pinned: impl Fn(u32, u32) -> bool,
) -> Sheet {
    let spacing = WIDTH / (columns.max(rows) - 1) as f32;
    let step = TickStep {
        seconds: SECONDS,
        ..TickStep::default()
    };
    let place = |row: u32, column: u32| Vec3::new(column as f32, 0.0, row as f32) * spacing;
    Sheet::new((columns, rows), spacing, material, step, place, pinned)
}

/// The largest stretch of rows and columns.
fn stretch(sheet: &Sheet) -> f64 {
    let places: Vec<Vec3> = sheet.particles.positions().collect();
    let springs = sheet.springs.iter();
    let structural = springs.filter(|spring| spring.kind == SpringKind::Structural);
    let stretches = structural.map(|spring| {
        let [a, b] = spring.ends.map(|end| places[end as usize].as_dvec3());
        a.distance(b) / f64::from(spring.rest_length) - 1.0
    });
    stretches.fold(0.0, f64::max)
}

/// Three seconds of 64² rigid threads in 20 sub-steps a tick. Without what is solved again, the largest stretch of the last
/// second is 2 to 20 %. A few ticks need more than the four rounds that are done, where the cloth cracks like a
/// whip: 1.5 % in three of 60 ticks by its centre, which 2 % leaves room for.
#[test]
fn a_large_cloth_stretches_by_half_a_per_cent_however_it_is_hung() {
    type Pinned = fn(u32, u32) -> bool;
    let ways: [(&str, Pinned); 5] = [
        ("two corners", |row, column| row == 0 && column % 63 == 0),
        ("one corner", |row, column| row == 0 && column == 0),
        ("centre", |row, column| row == 32 && column == 32),
        ("diagonal", |row, column| row == column),
        ("top row", |row, _| row == 0),
    ];
    for (name, pinned) in ways {
        let mut sheet = flat((64, 64), threads(0.0, 0.0), pinned);
        sheet.step.substeps = 20;
        let (scale, [_, begins]) = (sheet.fall(), sheet.energy());
        let (mut largest, mut beyond, mut highest) = (0.0_f64, 0, begins);
        for tick in 0..180 {
            sheet.tick(|_, _| {});
            highest = highest.max(sheet.energy()[1]);
            if tick >= 120 {
                let found = stretch(&sheet);
                largest = largest.max(found);
                beyond += u32::from(found > LEFT);
            }
        }
        let gain = (highest - begins) / scale;
        println!("{name}: {largest:.4}, {beyond} ticks beyond the limit, energy {gain:.5}");
        assert!(largest < 0.02 && beyond <= 6, "{name}: {largest}, {beyond}");
        // 0.1 % are the first sub-steps of the fall, in which energy is known to half a sub-step.
        assert!(gain < 1.0e-3, "{name}: {gain}");
    }
}

/// `SplitMix64`, from 0 to 1.
fn random(seed: &mut u64) -> f32 {
    *seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (*seed ^ (*seed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 24) as f32
}

/// Cloths of any size, with up to three pins anywhere that are shaken together by 10 cm at up to 2 Hz, in the sub-steps
/// that they need. The last three seconds of four; a tick in ten may need more rounds than are done.
#[test]
fn any_cloth_with_shaken_pins_holds_the_limit() {
    let mut seed = 7;
    for _ in 0..8 {
        let mut number = |from: f32, to: f32| from + (to - from) * random(&mut seed);
        let size = [(); 2].map(|()| number(20.0, 90.0) as u32);
        let pins = [(); 3].map(|()| [0, 1].map(|side| number(0.0, size[side] as f32) as u32));
        let count = number(1.0, 4.0) as usize;
        let frequency = number(0.2, 2.0);
        let [columns, rows] = size;
        let is_pinned = |row: u32, column: u32| pins[..count].contains(&[column, row]);
        let mut sheet = flat((columns, rows), threads(0.0, 0.0), is_pinned);
        let along = columns.max(rows) as usize;
        sheet.step.substeps = Substepping::needed(along, SECONDS);
        let held: Vec<(u32, Vec3)> = (pins[..count].iter())
            .map(|[column, row]| row * columns + column)
            .map(|at| {
                (
                    at,
                    sheet.particles.position(at as usize).expect("it exists"),
                )
            })
            .collect();
        let shift = |tick: u32| {
            let angle = std::f32::consts::TAU * frequency * tick as f32 * SECONDS;
            0.1 * Vec3::new(angle.sin(), 0.0, 1.0 - angle.cos())
        };
        let (mut largest, mut beyond) = (0.0_f64, 0);
        for tick in 0..240 {
            let moves: Vec<PinMotion> = (held.iter())
                .map(|&(particle, place)| PinMotion {
                    particle,
                    from: place + shift(tick),
                    to: place + shift(tick + 1),
                })
                .collect();
            let (particles, step) = (&mut sheet.particles, sheet.step);
            sheet.solver.advance(particles, step, &moves, |_, _| false);
            if tick >= 60 {
                let found = stretch(&sheet);
                largest = largest.max(found);
                beyond += u32::from(found > LEFT);
            }
        }
        println!("{columns} × {rows}, {count} pins, {frequency} Hz: {largest:.4}, {beyond} ticks");
        assert!(
            largest.is_finite() && beyond <= 18,
            "{size:?}: {largest}, {beyond}"
        );
    }
}

/// Elastic threads keep the stretch of their material: what is solved again is what their pull does not account for. In 20
/// sub-steps the cloth that hangs still is as long as in 80, within the limit.
#[test]
fn solving_again_makes_no_elastic_thread_stiffer() {
    let lengths = [20, 80].map(|substeps| {
        let material = ClothMaterial {
            damping: 0.3,
            ..threads(1.0e-3, 1.0e-3)
        };
        let mut sheet = flat((64, 64), material, |row, column| {
            row == 0 && column % 63 == 0
        });
        sheet.step.substeps = substeps;
        for _ in 0..600 {
            sheet.tick(|_, _| {});
        }
        stretch(&sheet)
    });
    println!("stretch in 20 and 80 sub-steps: {lengths:?}");
    assert!(lengths[0] > 0.05, "it stretches: {lengths:?}");
    assert!((lengths[0] - lengths[1]).abs() < LEFT, "{lengths:?}");
}
