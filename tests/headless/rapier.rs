//! Rapier moves the ball, and nothing else.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{
    Collider, NoUserData, RapierPhysicsPlugin, RigidBody, TimestepMode, Velocity,
};

use crate::support::*;

pub fn app_with_rapier() -> App {
    with_plugins(|app: &mut App| {
        app.insert_resource(TimestepMode::Fixed {
            dt: TICK,
            substeps: 1,
        })
        .add_plugins((
            RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
            DrapePlugins::default(),
        ));
    })
}

#[test]
fn rapier_moves_the_ball_and_the_cloth_follows() {
    let mut app = app_with_rapier();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let ball = app
        .world_mut()
        .spawn((
            RigidBody::KinematicVelocityBased,
            Velocity::linear(Vec3::Z * 2.0),
            Collider::ball(0.4),
            RapierClothCollider,
            Transform::from_xyz(0.75, -1.0, -1.0),
        ))
        .id();
    tick(&mut app, 64);
    let place = app
        .world()
        .get::<Transform>(ball)
        .expect("a transform")
        .translation;
    // A body that is two ticks late, while rapier takes it in, lacks 2 × 2/64 m.
    assert!((place.z - 1.0).abs() < 0.07, "rapier has moved it: {place}");
    assert_eq!(
        app.world().get::<ClothCollider>(ball),
        Some(&ClothCollider::ball(0.4))
    );
    assert!(
        app.world()
            .get::<ClothContacts>(cloth)
            .expect("contacts")
            .with(ball)
            .is_some()
    );
    assert!(
        position(&app, cloth, (10, 8)).z > 0.5,
        "the cloth has followed"
    );
    // The cloth is pushed out of where the ball is now, not of where it was a tick ago.
    let inside = particles(&app, cloth)
        .positions()
        .any(|position| position.distance(place) < 0.4099);
    assert!(!inside);
}

/// Adopted is the ball that rapier collides with: its radius, under its scale.
#[test]
fn radius_and_scale_are_rapiers() {
    let mut app = app_with_rapier();
    let ball = app
        .world_mut()
        .spawn((
            RigidBody::Fixed,
            Collider::ball(0.2),
            RapierClothCollider,
            Transform::from_xyz(0.7, -0.7, 0.0).with_scale(Vec3::splat(3.0)),
        ))
        .id();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 30);
    let collider = app.world().get::<ClothCollider>(ball).expect("adopted");
    let shape = collider.scaled(Vec3::splat(3.0)).expect("a valid one");
    let radius = shape.radius().expect("a ball's");
    assert!((radius - 0.6).abs() < 1e-6, "{radius}");
    let centre = Vec3::new(0.7, -0.7, 0.0);
    let nearest = particles(&app, cloth)
        .positions()
        .skip(16)
        .map(|position| position.distance(centre));
    let nearest = nearest.fold(f32::MAX, f32::min);
    assert!((nearest - 0.61).abs() < 1e-3, "{nearest}");
}

#[test]
fn what_is_no_ball_is_named_and_left_out() {
    let mut app = app_with_rapier();
    let place = Transform::from_xyz(0.7, -0.7, 0.0);
    let cuboid = app
        .world_mut()
        .spawn((Collider::cuboid(0.3, 0.3, 0.3), RapierClothCollider, place))
        .id();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 5);
    let fault = app.world().get::<ClothFault>(cuboid).expect("a fault");
    assert!(
        matches!(&fault.error, ClothError::NotABall { shape } if shape == "Cuboid"),
        "{fault:?}"
    );
    assert_eq!(
        app.world()
            .get::<ClothContacts>(cloth)
            .expect("contacts")
            .iter()
            .len(),
        0
    );
    app.world_mut()
        .entity_mut(cuboid)
        .insert(Collider::ball(0.3));
    tick(&mut app, 5);
    assert!(app.world().get::<ClothFault>(cuboid).is_none());
    assert_eq!(
        app.world()
            .get::<ClothContacts>(cloth)
            .expect("contacts")
            .iter()
            .len(),
        1
    );
}

/// Without its marker or its rapier collider, a ball is a cloth's collider no more.
#[test]
fn an_adopted_ball_can_be_released() {
    let mut app = app_with_rapier();
    let spawn = |app: &mut App| {
        let ball = (
            Collider::ball(0.3),
            RapierClothCollider,
            Transform::default(),
        );
        app.world_mut().spawn(ball).id()
    };
    let (first, second) = (spawn(&mut app), spawn(&mut app));
    tick(&mut app, 2);
    for ball in [first, second] {
        assert!(app.world().get::<ClothCollider>(ball).is_some());
    }
    app.world_mut()
        .entity_mut(first)
        .remove::<RapierClothCollider>();
    app.world_mut().entity_mut(second).remove::<Collider>();
    tick(&mut app, 2);
    for ball in [first, second] {
        assert!(app.world().get::<ClothCollider>(ball).is_none());
    }
}
