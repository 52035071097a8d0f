//! Cloth whose particles are put into a plane, a line, a point or a cube.

use std::time::Instant;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

const SIDE: usize = 20;
const PARTICLES: usize = SIDE * SIDE;

/// Numbers from 0 to 1 for each particle, spread evenly.
fn spread(index: usize) -> Vec3 {
    let part = |factor: usize| ((index * factor) % PARTICLES) as f32 / PARTICLES as f32;
    Vec3::new(part(7_919), part(104_729), part(1_299_709))
}

/// Contact of cloth with cloth lists a bounded number of pairs, says so, and leaves all finite. The longest tick is printed:
/// `cargo test --test headless crammed -- --nocapture`.
#[test]
fn crammed_cloth_is_let_go_and_said() {
    let states: [(&str, fn(usize) -> Vec3); 5] = [
        ("plane", |index| spread(index) * Vec3::new(1.0, 0.0, 1.0)),
        ("line", |index| spread(index) * Vec3::X),
        ("point", |_| Vec3::ZERO),
        ("cube", spread),
        ("small cube", |index| 0.05 * spread(index)),
    ];
    let mut longest = (0.0, "", 0.0);
    let mut said = 0;
    for (name, state) in states {
        for seconds in [1.0e-6, 1.0 / 60.0, 0.5] {
            let mut app = app();
            app.insert_resource(Time::<Fixed>::from_seconds(seconds));
            app.world_mut().spawn(ClothCollider::plane());
            let cloth = Cloth::new(SIDE as u32, SIDE as u32, 0.05);
            let place = Transform::from_xyz(0.0, 0.5, 0.0);
            let spawned = (cloth, Pins::none(), ClothSelfCollision::default(), place);
            let cloth = app.world_mut().spawn(spawned).id();
            (0..2).for_each(|_| app.update());
            let mut particles = app.world_mut().get_mut::<ClothParticles>(cloth);
            let particles = particles.as_mut().expect("a cloth");
            for index in 0..PARTICLES {
                let set = particles.set_position(index, state(index));
                set.expect("it exists");
            }
            for _ in 0..12 {
                let start = Instant::now();
                app.update();
                let passed = start.elapsed().as_secs_f64();
                if passed > longest.0 {
                    longest = (passed, name, seconds);
                }
                let stats = stats(&app, cloth);
                said += u32::from(stats.exceeded == Some(ClothLimit::Layers));
                // The pair of patches that goes beyond the limit lists all of its features.
                assert!(stats.layer_pairs <= 513 * PARTICLES, "{name}, {seconds} s");
                let particles = app.world().get::<ClothParticles>(cloth);
                let mut places = particles.expect("a cloth").positions();
                assert!(places.all(Vec3::is_finite), "{name}, {seconds} s");
            }
        }
    }
    assert!(said > 0, "the limit is reported");
    let (passed, name, seconds) = longest;
    println!(
        "longest tick: {:.0} ms ({name}, ticks of {seconds} s)",
        1.0e3 * passed
    );
}
