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
            Transform::from_xyz(0.7, -0.7, -0.59).with_scale(Vec3::splat(3.0)),
        ))
        .id();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    // It begins two centimetres inside of the cloth, which are let out slowly.
    tick(&mut app, 128);
    let collider = app.world().get::<ClothCollider>(ball).expect("adopted");
    let shape = collider.scaled(Vec3::splat(3.0)).expect("a valid one");
    let radius = shape.radius().expect("a ball's");
    assert!((radius - 0.6).abs() < 1e-6, "{radius}");
    let centre = Vec3::new(0.7, -0.7, -0.59);
    let nearest = particles(&app, cloth)
        .positions()
        .skip(16)
        .map(|position| position.distance(centre));
    let nearest = nearest.fold(f32::MAX, f32::min);
    assert!((nearest - 0.61).abs() < 1e-3, "{nearest}");
}

/// Whatever rapier has is adopted, as large as rapier has it and where it has it: a cloth that falls on it comes to lie
/// at the height of its top.
#[test]
fn any_shape_is_adopted_at_its_scale_and_place() {
    let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
    let square = square.map(|corner| corner - Vec3::new(0.5, 0.0, 0.5));
    let cube = |index: usize| {
        let sign = |bit: usize| if index & bit == 0 { -0.2 } else { 0.2 };
        Vec3::new(sign(1), sign(2), sign(4))
    };
    let cube: Vec<Vec3> = (0..8).map(cube).collect();
    let board = Collider::cuboid(0.3, 0.1, 0.3);
    let half = Vec3::splat(0.5);
    // Each with how high it reaches (m), at the scale that it is given.
    for (collider, scale, top) in [
        (Collider::cuboid(0.3, 0.2, 0.3), Vec3::ONE, 0.2),
        (
            Collider::cuboid(0.3, 0.2, 0.3),
            Vec3::new(1.0, 2.0, 1.0),
            0.4,
        ),
        (Collider::cylinder(0.2, 0.3), Vec3::ONE, 0.2),
        (Collider::cylinder(0.2, 0.3), half, 0.1),
        (Collider::cone(0.3, 0.3), Vec3::ONE, 0.3),
        (Collider::capsule_x(0.2, 0.15), Vec3::ONE, 0.15),
        (Collider::round_cuboid(0.2, 0.1, 0.2, 0.1), Vec3::ONE, 0.2),
        (
            Collider::convex_hull(&cube).expect("a hull"),
            Vec3::ONE,
            0.2,
        ),
        (
            Collider::trimesh(square.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).expect("a mesh"),
            Vec3::ONE,
            0.0,
        ),
        (
            Collider::heightfield(vec![0.1; 9], 3, 3, Vec3::ONE),
            Vec3::ONE,
            0.1,
        ),
        (
            Collider::compound(vec![(Vec3::Y * 0.3, Quat::IDENTITY, board.clone())]),
            Vec3::ONE,
            0.4,
        ),
        (
            Collider::compound(vec![(Vec3::Y * 0.3, Quat::IDENTITY, board)]),
            half,
            0.2,
        ),
    ] {
        let mut app = app_with_rapier();
        let name = format!("{:?} {scale}", collider.raw);
        let place = Transform::from_xyz(0.1, 1.0, 0.0).with_scale(scale);
        let entity = (RigidBody::Fixed, collider, RapierClothCollider, place);
        let entity = app.world_mut().spawn(entity).id();
        let (columns, spacing) = (9, 0.05);
        let cloth = Cloth::new(columns, columns, spacing).lying().centred();
        let above = Transform::from_xyz(0.1, 1.0 + top + 0.05, 0.0);
        let cloth = (cloth, Pins::none(), above);
        let cloth = app.world_mut().spawn(cloth).id();
        tick(&mut app, 40);
        assert!(app.world().get::<ClothFault>(entity).is_none(), "{name}");
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        let middle = frame.to_world(position(&app, cloth, (4, 4))).y - 1.0;
        // The particle's radius above it; over a tip, triangles that slope by up to 60° keep it as far, so it is up to
        // 0.01/cos 60° above.
        let above = middle - top;
        assert!(above > 0.006 && above < 0.02, "{name}: {middle} m");
    }
}

/// A line is nothing that cloth can touch: it is named, and left out until it is something else.
#[test]
fn what_has_no_surface_is_named_and_left_out() {
    let mut app = app_with_rapier();
    let line = Collider::polyline(vec![Vec3::ZERO, Vec3::X], None);
    let place = Transform::from_xyz(0.7, -0.7, 0.0);
    let line = (line, RapierClothCollider, place);
    let line = app.world_mut().spawn(line).id();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 5);
    let fault = app.world().get::<ClothFault>(line).expect("a fault");
    assert!(
        matches!(&fault.error, ClothError::Shape(ShapeError::NoSuchShape { shape }) if shape == "Polyline"),
        "{fault:?}"
    );
    let touched = |app: &App| {
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        contacts.iter().len()
    };
    assert_eq!(touched(&app), 0);
    app.world_mut().entity_mut(line).insert(Collider::ball(0.3));
    tick(&mut app, 5);
    assert!(app.world().get::<ClothFault>(line).is_none());
    assert_eq!(touched(&app), 1);
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
