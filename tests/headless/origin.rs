//! Worlds whose origin jumps.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    characters::arm::{By, Worn, dress, spawn_arm},
    snapshot::scene::{Origin, everything},
    support::*,
};

/// What the game does: all that has no parent is elsewhere, and so is what it moves.
fn jump(app: &mut App, by: Vec3) {
    let mut roots = app
        .world_mut()
        .query_filtered::<&mut Transform, Without<ChildOf>>();
    for mut place in roots.iter_mut(app.world_mut()) {
        place.translation += by;
    }
    if let Some(mut origin) = app.world_mut().get_resource_mut::<Origin>() {
        origin.0 += by;
    }
    shift_cloths(app.world_mut(), by).expect("a finite jump");
}

/// Cloths of every kind, awake or asleep, go on as without the jump: in the tick after it each particle is where and as fast as it is without,
/// but for what numbers of that size are rounded by; where nothing is rounded away, to the last bit.
#[test]
fn nothing_feels_a_jump_of_the_origin() {
    let late = if is_long() { 330 } else { 96 };
    for (by, start) in [
        (Vec3::new(1024.0, -512.0, 256.0), 5),
        (Vec3::new(-3000.3, 12.7, 900.1), 40),
        (Vec3::new(8192.0, 0.0, 0.0), 330),
        (Vec3::new(0.1, 0.0, -0.1), late),
    ] {
        let [mut still, mut jumping] = [0; 2].map(|_| everything().0);
        let (_, cloths) = everything();
        tick(&mut still, start);
        tick(&mut jumping, start);
        jump(&mut jumping, by);
        // Places of the world are up to 170 m from the origin, and it is by products of some of them that each is told.
        let rounding = 32.0 * f32::EPSILON * (by.abs().max_element() + 170.0);
        for number in 1..=3 {
            tick(&mut still, 1);
            tick(&mut jumping, 1);
            for (index, cloth) in cloths.iter().enumerate() {
                let context = format!("cloth {index}, {number} ticks after {by} at {start}");
                let (was, is) = (stats(&still, *cloth), stats(&jumping, *cloth));
                assert_eq!(was.is_asleep, is.is_asleep, "{context}");
                assert_eq!(was.level, is.level, "{context}");
                let (was, is) = (particles(&still, *cloth), particles(&jumping, *cloth));
                let places = was.positions().zip(is.positions());
                let off = places.map(|(was, is)| was.distance(is)).fold(0.0, f32::max);
                // What is held by two things that are rounded each is pulled by either.
                assert!(off <= 4.0 * number as f32 * rounding, "{context}: {off} m");
                let speed = was.largest_speed() - is.largest_speed();
                assert!(
                    speed.abs() < 8.0 * rounding / TICK,
                    "{context}: {speed} m/s"
                );
            }
        }
    }
}

/// A cloth that sleeps on a ball, on an arm, on cloth, before a fan that stands still or on a skeleton sleeps through a hundred
/// jumps, with the same bits. Its mesh is not written again elsewhere.
#[test]
fn what_sleeps_sleeps_on() {
    let mut app = app_that_draws(FixedUpdate);
    let at = Transform::from_xyz;
    let damped = ClothMaterial {
        damping: 0.05,
        ..default()
    };
    let vehicle = (
        at(5.0, 0.3, 2.0),
        Name::new("vehicle"),
        Visibility::default(),
    );
    let world = app.world_mut();
    let vehicle = world.spawn(vehicle).id();
    let corners = || Pins::new([Corner::TopLeft, Corner::TopRight].map(Pin::Corner));
    let lying = || (Cloth::new(9, 9, 0.1).lying().centred(), damped);
    let arm = spawn_arm(&mut app, By::Mesh, at(0.0, 3.0, 0.0));
    let pinned = Pins::new([Corner::TopLeft, Corner::BottomRight].map(Pin::Corner));
    let sheet = dress(&mut app, &arm, Worn::Sheet, (pinned, damped));
    let world = app.world_mut();
    let cloths = [
        sheet,
        world.spawn((lying(), corners(), at(0.0, 0.0, 0.0))).id(),
        world.spawn((lying(), corners(), at(3.0, 0.0, 1.0))).id(),
        world
            .spawn((lying(), ChildOf(vehicle), at(0.0, 1.0, 0.0)))
            .id(),
    ];
    world.spawn((ClothCollider::ball(0.3), at(0.0, -0.4, 0.0)));
    let turned = Quat::from_rotation_y(0.3);
    let ground = (
        ClothCollider::cuboid(0.3, 0.1, 0.3),
        at(0.0, -1.2, 0.1).with_rotation(turned),
    );
    world.spawn((ground, ChildOf(vehicle)));
    let fan = ClothWindZone::ball(2.0, Vec3::new(0.1, 0.0, 0.2));
    world.spawn((fan, at(3.0, 0.5, 1.0)));
    let asleep = |app: &App| cloths.iter().all(|cloth| stats(app, *cloth).is_asleep);
    for _ in 0..4000 {
        tick(&mut app, 1);
        if asleep(&app) {
            break;
        }
    }
    assert!(asleep(&app), "after a minute");
    let before = cloths.map(|cloth| particles(&app, cloth).clone());
    let mut way = Vec3::ZERO;
    for count in 0..100 {
        let by =
            Vec3::new(700.3, -1.1, 0.01 * count as f32) * if count % 3 == 0 { -1.9 } else { 1.0 };
        way += by;
        jump(&mut app, by);
        tick(&mut app, 1);
        assert!(asleep(&app), "awake after {count} jumps");
    }
    for (cloth, before) in cloths.iter().zip(&before) {
        assert!(before == particles(&app, *cloth));
    }
    // And it wakes as it would have.
    let mut balls = app.world_mut().query::<(&ClothCollider, &mut Transform)>();
    for (collider, mut place) in balls.iter_mut(app.world_mut()) {
        if *collider == ClothCollider::ball(0.3) {
            place.translation.y += 0.05 + 1.0e-4 * way.length();
        }
    }
    tick(&mut app, 2);
    assert!(!stats(&app, cloths[1]).is_asleep);
}

/// A jump that is none is said, and nothing is changed; a world without cloth has none to shift.
#[test]
fn a_jump_is_finite() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::new(5, 5, 0.1)).id();
    tick(&mut app, 3);
    let before = *app.world().get::<ClothFrame>(cloth).expect("a frame");
    for by in [Vec3::NAN, Vec3::X * f32::INFINITY] {
        let error = shift_cloths(app.world_mut(), by).expect_err("no jump");
        assert!(error.to_string().contains("origin"), "{error}");
        assert_eq!(app.world().get::<ClothFrame>(cloth), Some(&before));
    }
    assert_eq!(shift_cloths(&mut World::new(), Vec3::X), Ok(()));
}

/// Between two ticks, what is drawn goes along too: in its entity's own lengths it stays where it was.
#[test]
fn what_is_drawn_goes_along() {
    let mut app = app_that_draws(FixedUpdate);
    let vehicle = Transform::from_xyz(2.0, 1.0, 0.0);
    let vehicle = app.world_mut().spawn((vehicle, Visibility::default())).id();
    let attached = ClothAttachments::new([(Pin::Row(0), vehicle)]);
    let cloth = (Cloth::new(9, 9, 0.1), Pins::none(), attached);
    let cloth = app.world_mut().spawn(cloth).id();
    let drive = move |mut places: Query<&mut Transform>| {
        let mut place = places.get_mut(vehicle).expect("it is there");
        place.translation.x += 0.05;
    };
    app.add_systems(FixedUpdate, drive.before(ClothSystems::Prepare));
    tick(&mut app, 20);
    let part = std::time::Duration::from_secs_f32(TICK / 4.0);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(part));
    let mut before: Option<Vec<Vec3>> = None;
    for frame in 0..40 {
        let by = Vec3::new(100.0, 0.0, -20.0);
        let jumps = frame % 10 == 5;
        if jumps {
            jump(&mut app, by);
        }
        app.update();
        let place = *app.world().get::<GlobalTransform>(cloth).expect("a place");
        let drawn: Vec<Vec3> = crate::mesh::vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION)
            .into_iter()
            .map(|at| place.transform_point(at))
            .collect();
        if let Some(before) = before.replace(drawn.clone()) {
            let by = if jumps { by } else { Vec3::ZERO };
            let moved = drawn
                .iter()
                .zip(&before)
                .map(|(is, was)| is.distance(*was + by));
            let moved = moved.fold(0.0, f32::max);
            // The way of a tick at once, as nobody interpolates the vehicle, a fifth more for what swings, and rounding at 400 m.
            assert!(moved < 1.2 * 0.05 + 1.0e-3, "{moved} m in frame {frame}");
        }
    }
}
