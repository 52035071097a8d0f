//! Cloth that touches cloth: itself, and others.

use bevy::prelude::*;
use bevy_drape::{
    contact::intersections,
    plugin::{ClothBuilt, ClothScratch},
    prelude::*,
};

use crate::{push_back::cloth_momentum, support::*};

/// Triangles that intersect, among all cloths, by brute force.
fn crossings(app: &mut App) -> usize {
    let world = app.world_mut();
    let mut cloths = world.query::<(&ClothBuilt, &ClothParticles, &ClothFrame)>();
    let places: Vec<_> = cloths
        .iter(world)
        .map(|(built, particles, frame)| {
            let places = particles.positions().map(|place| frame.to_world(place));
            (built.surface().clone(), places.collect::<Vec<_>>())
        })
        .collect();
    let cloths: Vec<_> = places
        .iter()
        .map(|(surface, places)| (&**surface, places.clone()))
        .collect();
    intersections(&cloths)
}

/// A sheet that stands on its lower edge, leaning a little, and falls.
fn standing(app: &mut App, place: Transform) -> Entity {
    let cloth = Cloth::new(16, 24, 0.04).centred();
    let layers = ClothSelfCollision::of_thickness(0.008);
    let leaning = place.with_rotation(Quat::from_rotation_x(0.1));
    let spawned = (cloth, Pins::none(), layers, leaning);
    app.world_mut().spawn(spawned).id()
}

#[test]
fn a_sheet_that_falls_into_folds_does_not_pass_through_itself() {
    let mut app = app();
    app.world_mut().spawn(ClothCollider::plane());
    let cloth = standing(&mut app, Transform::from_xyz(0.0, 0.55, 0.0));
    let mut most = 0;
    for passed in 0..150 {
        tick(&mut app, 1);
        assert_eq!(crossings(&mut app), 0, "after {passed} ticks");
        most = most.max(
            app.world()
                .get::<ClothStats>(cloth)
                .expect("stats")
                .layer_pairs,
        );
    }
    assert!(most > 100, "{most} pairs: it lies on itself");
}

/// What it does is tested as well.
#[test]
fn without_self_collision_it_does_and_nothing_is_looked_at() {
    let mut app = app();
    app.world_mut().spawn(ClothCollider::plane());
    let cloth = standing(&mut app, Transform::from_xyz(0.0, 0.55, 0.0));
    tick(&mut app, 1);
    app.world_mut()
        .entity_mut(cloth)
        .remove::<ClothSelfCollision>();
    let mut worst = 0;
    for _ in 0..150 {
        tick(&mut app, 1);
        worst = worst.max(crossings(&mut app));
        let stats = app.world().get::<ClothStats>(cloth).expect("stats");
        assert_eq!((stats.layer_pairs, stats.layer_searches), (0, 0));
    }
    assert!(worst > 0, "the scene asks for it");
}

/// A sheet held by its edges, turned and moved in the world, and another that falls on it.
#[test]
fn a_cloth_lies_on_another_in_frames_that_differ() {
    let mut app = app();
    let layers = ClothSelfCollision::of_thickness(0.01);
    let below = Cloth::new(24, 24, 0.04).lying().centred();
    let held = Pins::new([Pin::Row(0), Pin::Row(23)]);
    let turned = Transform::from_xyz(3.0, 1.0, -2.0).with_rotation(Quat::from_rotation_y(0.7));
    let world = app.world_mut();
    let below = world.spawn((below, held, layers, turned)).id();
    let above = Cloth::new(12, 12, 0.04).lying().centred();
    let place = Transform::from_xyz(3.0, 1.1, -2.0).with_rotation(Quat::from_rotation_x(0.2));
    let above = world.spawn((above, Pins::none(), layers, place)).id();
    for passed in 0..192 {
        tick(&mut app, 1);
        assert_eq!(crossings(&mut app), 0, "after {passed} ticks");
    }
    let height = |cloth| {
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        let places = particles(&app, cloth).positions();
        places.map(|place| frame.to_world(place).y).sum::<f32>()
            / particles(&app, cloth).len() as f32
    };
    assert!(height(above) > 0.4, "{} m: it is held", height(above));
    assert!(height(below) > 0.4, "{} m", height(below));
}

/// They sleep together, and wake when what lies above is pushed.
#[test]
fn sheets_on_each_other_sleep_and_wake() {
    let mut app = app();
    app.world_mut().spawn(ClothCollider::plane());
    let sheets: Vec<Entity> = (0..2)
        .map(|index| {
            let cloth = Cloth::new(10, 10, 0.05).lying().centred();
            let layers = ClothSelfCollision::of_thickness(0.01);
            let place = Transform::from_xyz(0.0, 0.01 + 0.015 * index as f32, 0.0)
                .with_rotation(Quat::from_rotation_y(0.15 * index as f32));
            let spawned = (cloth, Pins::none(), layers, place);
            app.world_mut().spawn(spawned).id()
        })
        .collect();
    let are_asleep = |app: &App| {
        let is_asleep = |sheet: &Entity| {
            app.world()
                .get::<ClothStats>(*sheet)
                .is_some_and(|stats| stats.is_asleep)
        };
        sheets.iter().all(is_asleep)
    };
    for passed in 0..640 {
        tick(&mut app, 1);
        assert_eq!(crossings(&mut app), 0, "after {passed} ticks");
        if are_asleep(&app) {
            break;
        }
    }
    assert!(are_asleep(&app), "after ten seconds");
    let top = sheets[1];
    change(&mut app, top, |particles: &mut ClothParticles| {
        for index in 0..particles.len() {
            let sideways = Vec3::new(1.0, 0.0, 0.0);
            particles.set_velocity(index, sideways).expect("it exists");
        }
    });
    tick(&mut app, 30);
    let below = app.world().get::<ClothStats>(sheets[0]).expect("stats");
    assert!(!below.is_asleep, "what lies on it moves");
}

#[test]
fn bad_thickness_is_told_and_others_go_on() {
    let mut app = app();
    let good = standing(&mut app, Transform::IDENTITY);
    let bad = standing(&mut app, Transform::from_xyz(9.0, 0.0, 0.0));
    for (thickness, friction) in [
        (0.0, 0.3),
        (-1.0, 0.3),
        (f32::NAN, 0.3),
        (0.0201, 0.3),
        (0.01, f32::NAN),
        (0.01, -1.0),
    ] {
        app.world_mut().entity_mut(bad).insert(ClothSelfCollision {
            thickness,
            friction,
            ..default()
        });
        tick(&mut app, 2);
        let fault = app.world().get::<ClothFault>(bad);
        let error = fault.map(|fault| fault.error.clone());
        match thickness {
            0.0201 => assert!(
                matches!(
                    error,
                    Some(ClothError::SelfCollision(
                        SelfCollisionError::TooThick { .. }
                    ))
                ),
                "{error:?}"
            ),
            _ => assert!(
                matches!(error, Some(ClothError::Quantity(_))),
                "{thickness} {friction} {error:?}"
            ),
        }
        assert!(app.world().get::<ClothFault>(good).is_none());
    }
    app.world_mut()
        .entity_mut(bad)
        .insert(ClothSelfCollision::of_thickness(0.02));
    tick(&mut app, 2);
    assert!(app.world().get::<ClothFault>(bad).is_none());
}

/// Nearest points that are still good for a while are found anew then, at another moment: layers part as well as before, if not to
/// the same bits.
#[test]
fn what_was_found_may_be_forgotten() {
    let begin = || {
        let mut app = app();
        app.world_mut().spawn(ClothCollider::plane());
        let cloth = standing(&mut app, Transform::from_xyz(0.0, 0.55, 0.0));
        (app, cloth)
    };
    let forget = |app: &mut App, cloth: Entity| {
        change(app, cloth, |scratch: &mut ClothScratch| {
            *scratch = default();
        });
    };
    let (mut app, cloth) = begin();
    for passed in 0..100 {
        tick(&mut app, 1);
        assert_eq!(crossings(&mut app), 0, "after {passed} ticks");
        forget(&mut app, cloth);
    }
    let ends = [false, true].map(|forgets| {
        let (mut app, cloth) = begin();
        tick(&mut app, 99);
        if forgets {
            forget(&mut app, cloth);
        }
        tick(&mut app, 1);
        particles(&app, cloth).clone()
    });
    let both = ends[0].positions().zip(ends[1].positions());
    let off = both.map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
    // In a tick nearest points are off by no more than what they are good for: a tenth of the 8 mm between layers.
    assert!(off < 8.0e-4, "{off} m");
}

/// They lie across each other, turned by this angle from one to the next (rad), and fall asleep within this many ticks
/// of the drop. A minute later none has moved.
fn pile_sleeps(turn: f32, ticks: usize) {
    let mut app = app();
    app.world_mut().spawn(ClothCollider::plane());
    let sheets: Vec<Entity> = (0..10)
        .map(|index| {
            let cloth = Cloth::new(8, 8, 0.1).lying().centred();
            let layers = ClothSelfCollision::of_thickness(0.01);
            let place = Transform::from_xyz(0.0, 0.01 + 0.02 * index as f32, 0.0)
                .with_rotation(Quat::from_rotation_y(turn * index as f32));
            let spawned = (cloth, Pins::none(), layers, place);
            app.world_mut().spawn(spawned).id()
        })
        .collect();
    let sleeps = |app: &App, sheet: Entity| {
        let stats = app.world().get::<ClothStats>(sheet);
        stats.is_some_and(|stats| stats.is_asleep)
    };
    let all_sleep = |app: &App| sheets.iter().all(|&sheet| sleeps(app, sheet));
    let mut passed = 0;
    while passed < ticks && !all_sleep(&app) {
        tick(&mut app, 1);
        passed += 1;
        assert_eq!(crossings(&mut app), 0, "{turn} rad, after {passed} ticks");
    }
    println!("{turn} rad: {passed} ticks");
    assert!(all_sleep(&app), "{turn} rad: after {passed} ticks");
    let places = |app: &App| {
        let of = |&sheet: &Entity| particles(app, sheet).positions().collect::<Vec<_>>();
        sheets.iter().flat_map(of).collect::<Vec<_>>()
    };
    let before = places(&app);
    tick(&mut app, 60 * 64);
    assert!(places(&app) == before, "{turn} rad: creeps");
}

/// Half a second to land, and half a second is the shortest time of rest that is waited for.
#[test]
fn ten_sheets_in_a_pile_fall_asleep() {
    for turn in [0.13, -0.17, 0.02, 0.2, 0.4, 0.7] {
        pile_sleeps(turn, 320);
    }
}

/// Two sheets that float, so far apart, of which the upper one may be put elsewhere.
fn floating(apart: f32) -> (App, [Entity; 2]) {
    let mut app = app();
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let sheets = [0.0, apart].map(|height| {
        let cloth = Cloth::new(10, 10, 0.05).lying().centred();
        let layers = ClothSelfCollision {
            with_itself: false,
            ..ClothSelfCollision::of_thickness(0.01)
        };
        let awake = ClothSettings {
            sleeps: false,
            ..default()
        };
        let place = Transform::from_xyz(0.003, height, 0.002);
        let spawned = (cloth, Pins::none(), layers, awake, place);
        app.world_mut().spawn(spawned).id()
    });
    tick(&mut app, 4);
    (app, sheets)
}

fn put(app: &mut App, sheet: Entity, height: f32) {
    let place = Transform::from_xyz(0.003, height, 0.002);
    app.world_mut()
        .entity_mut(sheet)
        .insert((place, ClothTeleport));
    tick(app, 2);
}

/// A jump is no motion that the particles' own frame shows.
#[test]
fn what_jumps_onto_another_is_found() {
    let (mut app, sheets) = floating(0.2);
    let pairs = |app: &App| {
        let stats = app.world().get::<ClothStats>(sheets[0]).expect("stats");
        stats.layer_pairs
    };
    assert_eq!(pairs(&app), 0);
    put(&mut app, sheets[1], 0.006);
    let [below, above] = sheets.map(|sheet| particles(&app, sheet).positions());
    let gaps = below
        .zip(above)
        .map(|(below, above)| above.y + 0.006 - below.y);
    // Layers are pushed apart to a thickness, less a twenty-fifth.
    let least = gaps.fold(f32::INFINITY, f32::min);
    assert!(least > 0.96 * 0.01, "{least} m apart");
    assert_eq!(crossings(&mut app), 0);
}

/// More sub-steps are for those that touch.
#[test]
fn what_has_left_others_takes_no_more_substeps_for_them() {
    let (mut app, sheets) = floating(0.2);
    let substeps = |app: &App| {
        let stats = app.world().get::<ClothStats>(sheets[0]).expect("stats");
        stats.substeps
    };
    let alone = substeps(&app);
    put(&mut app, sheets[1], 0.006);
    assert!(substeps(&app) > alone, "they touch");
    put(&mut app, sheets[1], 20.0);
    assert_eq!(substeps(&app), alone);
}

/// Two sheets in space, one slowly thrown onto the other, keep the momentum that they have together, while they touch and after: what
/// holds them between two passes takes some of it from each particle, to a hundredth of it in a second.
#[test]
fn what_touches_in_flight_keeps_its_momentum() {
    for speed in [0.02_f32, 0.2, 1.0] {
        let (mut app, sheets) = floating(0.02);
        for sheet in sheets {
            app.world_mut().entity_mut(sheet).insert(ClothMaterial {
                damping: 0.0,
                ..ClothMaterial::COTTON
            });
        }
        tick(&mut app, 2);
        let frame = *app.world().get::<ClothFrame>(sheets[1]).expect("a frame");
        let way = frame.isometry().rotation.inverse() * Vec3::NEG_Y * speed;
        change::<ClothParticles>(&mut app, sheets[1], |particles| {
            for index in 0..particles.len() {
                // Not all alike: some touch first.
                let part = 1.0 + 0.2 * (index % 7) as f32 / 7.0;
                particles
                    .set_velocity(index, way * part)
                    .expect("it exists");
            }
        });
        let momentum = |app: &App| {
            let both = sheets.map(|sheet| cloth_momentum(app, sheet).0);
            both[0] + both[1]
        };
        let start = momentum(&app);
        let mut pairs = 0;
        for _ in 0..128 {
            tick(&mut app, 1);
            pairs = pairs.max(stats(&app, sheets[0]).layer_pairs);
        }
        let off = (momentum(&app) - start).length() / start.length();
        println!("{speed} m/s: off by {off}, {pairs} pairs");
        assert!(pairs > 0, "they have met");
        assert!(off < 0.01, "{speed} m/s: off by {off}");
    }
}

/// A sheet that is thrown down onto its edge moves all alike until the edge meets the floor, and folds within a few sub-steps then: what
/// waited to be looked at as nothing came nearer to anything is looked at.
#[test]
fn a_sheet_thrown_onto_its_edge_does_not_pass_through_itself() {
    for speed in [5.0_f32, 20.0] {
        let mut app = app();
        app.world_mut().spawn(ClothCollider::plane());
        let tilt = Quat::from_euler(EulerRot::XYZ, 0.1, 0.03, 0.02);
        let place = Transform::from_xyz(0.0, 0.6, 0.0).with_rotation(tilt);
        let sheet = Cloth::new(24, 24, 1.0 / 23.0).centred();
        let layers = ClothSelfCollision::of_thickness(0.008);
        let cloth = (sheet, Pins::none(), layers, place);
        let cloth = app.world_mut().spawn(cloth).id();
        tick(&mut app, 2);
        let frame = *app.world().get::<ClothFrame>(cloth).expect("a frame");
        let down = frame.isometry().rotation.inverse() * Vec3::NEG_Y * speed;
        change::<ClothParticles>(&mut app, cloth, |particles| {
            for index in 0..particles.len() {
                particles.set_velocity(index, down).expect("it exists");
            }
        });
        for passed in 0..30 {
            tick(&mut app, 1);
            let count = crossings(&mut app);
            assert_eq!(count, 0, "{speed} m/s, after {passed} ticks");
        }
    }
}

/// Layers that were near each other are those of other particles once the cloth is built again, finer: alone, and beside another.
#[test]
fn a_cloth_in_contact_may_become_finer() {
    let (mut app, sheets) = floating(0.006);
    tick(&mut app, 4);
    let finer = Cloth::new(40, 40, 0.02).lying().centred();
    app.world_mut().entity_mut(sheets[0]).insert(finer.clone());
    tick(&mut app, 4);
    assert_eq!(particles(&app, sheets[0]).len(), 1600);
    let alone = standing(&mut app, Transform::from_xyz(9.0, 0.55, 0.0));
    app.insert_resource(ClothGravity(Vec3::NEG_Y * GRAVITY));
    app.world_mut().spawn(ClothCollider::plane());
    tick(&mut app, 60);
    assert!(stats(&app, alone).layer_pairs > 0);
    app.world_mut().entity_mut(alone).insert(finer);
    tick(&mut app, 4);
    assert_eq!(particles(&app, alone).len(), 1600);
}
