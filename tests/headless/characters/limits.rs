//! Limits of cloth that follows a skinned pose: max distance, blend and backstop.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::rig::*;
use crate::{meshes::sheets::*, support::*};

/// Painted distances: each particle is within its own in each tick, to rounding, and some are at it; those of the first row are
/// in the pose.
#[test]
fn each_particle_stays_within_its_max_distance() {
    let (mut app, rig) = animated(ClothSkin::painted());
    let mut at_limit = 0;
    go(&mut app, &rig, 1..128, |app| {
        let places = simulated(app, rig.cloth)
            .into_iter()
            .zip(skinned(app, &rig));
        for (vertex, (place, truth)) in places.enumerate() {
            let distance = 0.05 * (vertex as u32 / SIDE) as f32;
            let is = place.distance(truth);
            assert!(is <= distance + ROUNDING, "{vertex}: {is} of {distance}");
            at_limit += u32::from(distance > 0.0 && is > 0.999 * distance);
        }
    });
    assert!(at_limit > 1000, "{at_limit}");
}

/// Halfway blended, half of the distance; of an infinite one, as far as the cloth is large.
#[test]
fn blend_shrinks_the_distance() {
    let half = ClothSkin {
        blend: 0.5,
        ..ClothSkin::within(0.2)
    };
    let (mut app, rig) = animated(half);
    let mut largest = 0.0_f32;
    let mut observe = |app: &mut App| {
        let places = simulated(app, rig.cloth)
            .into_iter()
            .zip(skinned(app, &rig));
        for (place, truth) in places {
            largest = largest.max(place.distance(truth));
        }
    };
    go(&mut app, &rig, 1..64, &mut observe);
    assert!((0.0999..0.1 + ROUNDING).contains(&largest), "{largest}");
    // It changes while it runs, there and back; what was held falls again, with the mass that it had.
    let masses: Vec<f32> = particles(&app, rig.cloth).inverse_masses().collect();
    for (blend, bound) in [
        (0.0, ROUNDING),
        (0.25, 0.05 + ROUNDING),
        (1.0, 0.2 + ROUNDING),
    ] {
        change::<ClothSkin>(&mut app, rig.cloth, |skin| skin.blend = blend);
        let mut largest = 0.0_f32;
        go(&mut app, &rig, 64..96, |app| {
            let places = simulated(app, rig.cloth)
                .into_iter()
                .zip(skinned(app, &rig));
            for (place, truth) in places {
                largest = largest.max(place.distance(truth));
            }
        });
        assert!(
            largest <= bound && largest >= 0.99 * (bound - ROUNDING),
            "{blend}: {largest}"
        );
    }
    let now: Vec<f32> = particles(&app, rig.cloth).inverse_masses().collect();
    assert_eq!(now, masses);
}

/// Nothing gets behind the backstop in any tick, and some lie on it: a sheet that faces up falls onto the balls below.
#[test]
fn nothing_gets_behind_the_backstop() {
    let (behind, radius) = (0.03, 0.4);
    let skin =
        ClothSkin::within(ClothPaint::at_rest(|place| place.z)).with_backstop(behind, radius);
    let mut app = app_that_draws(FixedUpdate);
    let rig = rig(&mut app, skin);
    let mut on_it = 0;
    for count in 0..96 {
        // Only turns of the whole: normals are the root's.
        let turn = Quat::from_rotation_x(0.3 * (6.0 * count as f32 * TICK).sin());
        change::<Transform>(&mut app, rig.root, |transform| transform.rotation = turn);
        tick(&mut app, 1);
        let places = simulated(&app, rig.cloth)
            .into_iter()
            .zip(skinned(&app, &rig));
        for (vertex, (place, truth)) in places.enumerate() {
            let centre = truth - turn * Vec3::Y * (behind + radius);
            let distance = place.distance(centre);
            assert!(distance >= radius - ROUNDING, "{vertex}: {distance}");
            let most = (vertex as u32 / SIDE) as f32 * 0.1;
            assert!(
                place.distance(truth) <= most + ROUNDING,
                "{vertex}: {place} {truth}"
            );
            on_it += u32::from(distance < radius + 1.0e-4);
        }
    }
    assert!(on_it > 500, "{on_it}");
}

/// A backstop that comes while the cloth moves, goes and comes again holds from the tick in which it comes; put back to before
/// that, the cloth does the same again.
#[test]
fn a_backstop_comes_and_goes() {
    let within = || ClothSkin::within(ClothPaint::at_rest(|place| place.z));
    let (mut app, rig) = animated(within());
    let run = |app: &mut App| {
        let mut behind = 0.0_f32;
        for round in 0..3 {
            let skin = within().with_backstop(0.02, 0.4);
            app.world_mut().entity_mut(rig.cloth).insert(skin);
            go(app, &rig, 20 * round..20 * round + 10, |app| {
                assert_eq!(fault(app, rig.cloth), None);
                let places = simulated(app, rig.cloth).into_iter();
                let off = places
                    .zip(skinned(app, &rig))
                    .map(|(at, pose)| at.distance(pose));
                behind = off.fold(behind, f32::max);
            });
            app.world_mut().entity_mut(rig.cloth).insert(within());
            go(app, &rig, 20 * round + 10..20 * round + 20, |app| {
                assert_eq!(fault(app, rig.cloth), None);
            });
        }
        assert!(behind <= 0.8 + ROUNDING, "{behind} m");
        particles(app, rig.cloth).clone()
    };
    let saved = ClothWorldSnapshot::of(app.world_mut());
    let once = run(&mut app);
    saved.restore(app.world_mut()).expect("the same world");
    assert!(once == run(&mut app), "others than the first time");
}

/// A free sheet that falls into its limits, and onto its backstops, has never more than the energy that it began with: to what its
/// unevenness is worth. What its springs hold, never negative, is left out.
#[test]
fn limits_feed_in_no_energy() {
    for material in [ClothMaterial::COTTON, ClothMaterial::RUBBER] {
        for backstop in [false, true] {
            let mut app = app();
            let material = ClothMaterial {
                damping: 0.0,
                ..material
            };
            let slack = ClothSkin::within(ClothPaint::at_rest(|place| 0.1 + place.x.abs()));
            let skin = match backstop {
                true => slack.with_backstop(0.05, 0.3),
                false => slack,
            };
            let cloth = (
                Cloth::new(12, 12, 0.05).lying(),
                Pins::none(),
                material,
                skin,
            );
            let cloth = app.world_mut().spawn(cloth).id();
            tick(&mut app, 1);
            let energy = |app: &App| -> f64 {
                let particles = particles(app, cloth);
                let each = (0..particles.len()).map(|index| {
                    let weight = particles.inverse_mass(index).expect("it exists");
                    let speed = particles.velocity(index).expect("it exists").length();
                    let height = particles.position(index).expect("it exists").y;
                    f64::from((0.5 * speed * speed + GRAVITY * height) / weight)
                });
                each.sum()
            };
            let lowest = |app: &App| {
                let places = particles(app, cloth).positions();
                places.map(|place| place.y).fold(0.0, f32::min)
            };
            let start = energy(&app);
            let mass: f64 = particles(&app, cloth)
                .inverse_masses()
                .map(|weight| 1.0 / f64::from(weight))
                .sum();
            let mut depth = 0.0_f32;
            for count in 0..256 {
                tick(&mut app, 1);
                depth = depth.min(lowest(&app));
                // A millimetre of height.
                let most = start + mass * f64::from(GRAVITY) * 1.0e-3;
                let now = energy(&app);
                assert!(now <= most, "{count}: {now} {start}, {backstop}");
            }
            assert!(depth < if backstop { -0.04 } else { -0.2 }, "{depth}");
        }
    }
}
