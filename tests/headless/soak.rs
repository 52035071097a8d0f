//! A hundred cloths in a storm: after a long time all is as at its begin.
//!
//! Ten seconds of it by default. `BEVY_DRAPE_SOAK=3600 cargo test --test headless soak -- --nocapture` is an hour, and prints each minute how long a
//! tick took and how much memory there is.

use std::{fs, time::Instant};

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

const CLOTHS: usize = 100;
const TICKS_A_SECOND: usize = 64;

/// Flags, curtains with a ball that swings into them, sheets that touch themselves, and balloons, in gusts.
fn storm() -> App {
    let mut app = app_that_draws(FixedUpdate);
    run_on_all_threads(&mut app);
    app.insert_resource(ClothWind {
        velocity: Vec3::new(14.0, 0.0, 6.0),
        gusts: 0.5,
        turbulence: 0.4,
        ..default()
    });
    let world = app.world_mut();
    let balloon = Sphere::new(0.3).mesh().ico(2).expect("few");
    let balloon = world.resource_mut::<Assets<Mesh>>().add(balloon);
    for number in 0..CLOTHS {
        let place = Vec3::new(3.0 * (number % 10) as f32, 0.0, 3.0 * (number / 10) as f32);
        let place = Transform::from_translation(place);
        let grid = || Cloth::new(8, 8, 0.15);
        match number {
            0..65 => world.spawn((grid(), Pins::new([Pin::Column(0)]), place)),
            65..97 => {
                world.spawn((
                    ClothCollider::ball(0.3),
                    place * Transform::from_xyz(0.6, -0.5, 0.2),
                ));
                world.spawn((grid(), place))
            }
            97 => world.spawn((grid(), ClothSelfCollision::default(), place)),
            _ => world.spawn((
                Cloth::mesh(),
                Mesh3d(balloon.clone()),
                Pins::new([Pin::Near {
                    point: Vec3::NEG_Y * 0.3,
                    radius: 0.05,
                }]),
                ClothPressure::gas(0.12),
                place,
            )),
        };
    }
    app
}

/// The memory of this process (bytes), as Linux says it; 0 elsewhere.
fn memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kibibytes = resident.and_then(|size| size.trim_end_matches("kB").trim().parse().ok());
    1024 * kibibytes.unwrap_or(0)
}

#[test]
fn a_storm_wears_nothing_out() {
    let told = std::env::var("BEVY_DRAPE_SOAK").ok();
    let seconds: usize = told.map_or(10, |told| told.parse().expect("seconds"));
    let mut app = storm();
    let (mut exceeded, mut touched, mut slowest) = (0, 0, 0.0_f64);
    let mut start = Instant::now();
    let mut memories = Vec::new();
    for second in 1..=seconds {
        for _ in 0..TICKS_A_SECOND {
            let start = Instant::now();
            app.update();
            slowest = slowest.max(start.elapsed().as_secs_f64());
        }
        let world = app.world_mut();
        let faults: Vec<&ClothFault> = world.query::<&ClothFault>().iter(world).collect();
        assert!(faults.is_empty(), "after {second} s: {faults:?}");
        let mut cloths = world.query::<&ClothParticles>();
        for particles in cloths.iter(world) {
            let farthest = particles.positions().map(Vec3::length).fold(0.0, f32::max);
            assert!(
                farthest < 5.0,
                "after {second} s: {farthest} m from its pins"
            );
        }
        exceeded += messages::<ClothLimitExceeded>(&mut app).len();
        touched += messages::<ClothTouchStarted>(&mut app).len();
        // What a test hears it keeps until it is asked.
        messages::<ClothTouchStopped>(&mut app);
        if second % 60 == 0 {
            memories.push(memory());
            let mean = 1000.0 * start.elapsed().as_secs_f64() / (60 * TICKS_A_SECOND) as f64;
            println!(
                "{} min: {mean:.2} ms a tick, the slowest {:.1}, {:.1} MiB, {exceeded} limits told, {touched} touches",
                second / 60,
                1000.0 * slowest,
                memories[memories.len() - 1] as f64 / 1_048_576.0
            );
            (slowest, start) = (0.0, Instant::now());
        }
    }
    // Each is told once, and again when it is ten times worse.
    assert!(exceeded <= CLOTHS, "{exceeded} warnings");
    assert!(touched > 0, "no curtain met its ball");
    // Where it runs alone: all was there after five minutes.
    if let Some(&[early, .., late]) = memories.get(4..) {
        let grown = late.saturating_sub(early);
        assert!(grown < 1 << 20, "{grown} bytes more");
    }
}
