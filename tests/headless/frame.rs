//! Where a cloth is: its transform at spawn and moved, its parents, its frame.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// Under a sheared transform, as a turned child of a stretched parent has it, the cloth keeps its size while it
/// is carried about.
#[test]
fn a_sheared_transform_does_not_shrink_the_cloth() {
    let mut app = app();
    let stretched = Transform::from_scale(Vec3::new(1.0, 2.0, 1.0));
    let parent = app.world_mut().spawn(stretched).id();
    let turned = Transform::from_rotation(Quat::from_rotation_z(0.8));
    let weightless = ClothSettings {
        gravity: Some(Vec3::ZERO),
        ..default()
    };
    let cloth = (Cloth::default(), Pins::none(), weightless, turned);
    let cloth = app.world_mut().spawn((cloth, ChildOf(parent))).id();
    tick(&mut app, 2);
    let size = |app: &App| position(app, cloth, (0, 0)).distance(position(app, cloth, (15, 15)));
    let before = size(&app);
    for step in 0..50 {
        change::<Transform>(&mut app, parent, |transform| {
            transform.translation.x = 0.01 * step as f32;
        });
        tick(&mut app, 1);
    }
    assert!(
        (size(&app) / before - 1.0).abs() < 1e-4,
        "{} {before}",
        size(&app)
    );
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let there = frame.from_world(frame.to_world(Vec3::ONE));
    assert!(there.distance(Vec3::ONE) < 1e-5);
}

/// The transform counts: place, turn and scale at spawn, parents too.
#[test]
fn the_transform_is_respected_at_spawn() {
    let mut app = app();
    let parent = app
        .world_mut()
        .spawn(Transform::from_xyz(10.0, 0.0, 0.0))
        .id();
    let turned = Transform::from_xyz(0.0, 5.0, 0.0)
        .with_rotation(Quat::from_rotation_y(std::f32::consts::FRAC_PI_2))
        .with_scale(Vec3::new(2.0, 3.0, 1.0));
    let cloth = app
        .world_mut()
        .spawn((
            Cloth::new(3, 3, 0.5),
            Pins::filter(|_, _| true),
            turned,
            ChildOf(parent),
        ))
        .id();
    tick(&mut app, 2);
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let corner = frame.to_world(position(&app, cloth, (2, 2)));
    // Two metres wide along −z, three high.
    assert!(
        corner.distance(Vec3::new(10.0, 2.0, -2.0)) < 1e-5,
        "{corner}"
    );
    assert!(
        frame
            .from_world(corner)
            .distance(position(&app, cloth, (2, 2)))
            < 1e-5
    );
}

/// Gravity points down in the world however the cloth is turned; a cloth of its own has its own.
#[test]
fn gravity_is_the_worlds_unless_a_cloth_has_its_own() {
    let mut app = app();
    let turned = Transform::from_rotation(Quat::from_euler(EulerRot::XYZ, 0.7, -1.1, 2.0));
    let free = (Cloth::new(3, 3, 0.5), Pins::none());
    let turned = app.world_mut().spawn((free.clone(), turned)).id();
    let gravity = Some(Vec3::X * 2.0);
    let own = app
        .world_mut()
        .spawn((
            free,
            ClothSettings {
                gravity,
                ..default()
            },
        ))
        .id();
    app.insert_resource(ClothGravity(Vec3::NEG_Z));
    tick(&mut app, 1);
    let velocity = |cloth: Entity| {
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        frame.isometry().rotation * particles(&app, cloth).velocity(4).expect("a particle")
    };
    assert!(velocity(turned).distance(Vec3::NEG_Z * TICK) < 2e-4);
    assert!(velocity(own).distance(Vec3::X * 2.0 * TICK) < 4e-4);
}

/// Pinned particles go with the transform, the others stay behind at first: a flag on a moving pole.
#[test]
fn a_moved_transform_carries_its_pins() {
    let mut app = app();
    let damped = ClothMaterial {
        damping: 0.05,
        ..default()
    };
    let cloth = app.world_mut().spawn((Cloth::default(), damped)).id();
    tick(&mut app, 2);
    change::<Transform>(&mut app, cloth, |transform| transform.translation.z = 0.05);
    tick(&mut app, 1);
    let world = |app: &App, cell| {
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        frame.to_world(position(app, cloth, cell)).z
    };
    assert_eq!(world(&app, (0, 3)), 0.05);
    // Its pins go at 3.2 m/s in that tick, and damping, relative to them, takes the others along: ½ k v Δt², k = −60 ln(1 − D).
    assert!((1e-4..1.5e-3).contains(&world(&app, (15, 3))));
    tick(&mut app, 64 * 30);
    assert!(
        (world(&app, (15, 3)) - 0.05).abs() < 1e-3,
        "it hangs below its pins again"
    );
}

/// A kilometre away a cloth moves as at the origin, bit for bit: it lives in its own frame.
#[test]
fn a_kilometre_away_is_as_good_as_here() {
    let mut app = app();
    let free = (Cloth::default(), Pins::new([Pin::Corner(Corner::TopLeft)]));
    let here = app.world_mut().spawn(free.clone()).id();
    let there = app
        .world_mut()
        .spawn((free, Transform::from_xyz(1000.0, -500.0, 1000.0)))
        .id();
    tick(&mut app, 128);
    assert_eq!(particles(&app, here), particles(&app, there));
}

/// A cloth whose other part, a collider, is at fault moves on, and its pins stay with its transform.
#[test]
fn a_faulty_collider_does_not_stop_its_cloth() {
    let mut app = app();
    let both = (Cloth::default(), ClothCollider::ball(-1.0));
    let cloth = app.world_mut().spawn(both).id();
    tick(&mut app, 2);
    for step in 1..10 {
        change::<Transform>(&mut app, cloth, |transform| {
            transform.translation.z = 0.01 * step as f32;
        });
        tick(&mut app, 1);
        assert_eq!(position(&app, cloth, (0, 3)), Vec3::new(0.3, 0.0, 0.0));
    }
    assert!(app.world().get::<ClothFault>(cloth).is_some());
    assert!(particles(&app, cloth).largest_speed() > 0.1);
}

/// What is moved while the clock stands still is carried along once it goes on: nothing is lost, nothing jumps.
#[test]
fn a_transform_moved_in_a_pause_counts_when_time_goes_on() {
    let mut app = with_plugins(DrapePlugins::new(Update));
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let ball = (
        ClothCollider::ball(0.4),
        Transform::from_xyz(0.75, -0.8, -0.45),
    );
    let ball = app.world_mut().spawn(ball).id();
    tick(&mut app, 2);
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    app.update();
    change::<Transform>(&mut app, cloth, |transform| transform.translation.x = 0.05);
    change::<Transform>(&mut app, ball, |transform| transform.translation.z = -0.3);
    (0..3).for_each(|_| app.update());
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    tick(&mut app, 1);
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    assert_eq!(
        frame.to_world(position(&app, cloth, (0, 0))),
        Vec3::X * 0.05
    );
    // The ball has come its 0.15 m in 20 sub-steps, and was not in the cloth all at once.
    let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
    let contact = contacts.with(ball).expect("a contact");
    assert!(contact.deepest_penetration < 0.03, "{contact:?}");
}
