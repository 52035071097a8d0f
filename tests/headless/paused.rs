//! Cloths that stand still on purpose, that are hidden, and that are no cloth any more.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

fn in_world(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame: &ClothFrame = app.world().get(cloth).expect("a frame");
    let positions = particles(app, cloth).positions();
    positions.map(|at| frame.to_world(at)).collect()
}

/// Nothing happens to it, by as much as a bit, nor does it cost sub-steps. Then it goes on as if no time had passed: to the last bit as
/// one beside it did before.
#[test]
fn a_paused_cloth_goes_on_where_it_stood() {
    let mut app = app();
    let flag = (Cloth::default(), Pins::new([Pin::Column(0)]));
    let cloth = app.world_mut().spawn(flag.clone()).id();
    let other = app.world_mut().spawn(flag).id();
    tick(&mut app, 20);
    assert_eq!(particles(&app, cloth), particles(&app, other));
    app.world_mut().entity_mut(cloth).insert(ClothPaused);
    let before = particles(&app, cloth).clone();
    tick(&mut app, 30);
    assert_eq!(particles(&app, cloth), &before);
    assert_eq!(stats(&app, cloth).substeps, 0);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    let ahead = particles(&app, other).clone();
    assert_ne!(&ahead, &before);
    app.world_mut().entity_mut(cloth).remove::<ClothPaused>();
    tick(&mut app, 30);
    assert_eq!(particles(&app, cloth), &ahead);
}

/// Its entity, or what it is attached to, goes away meanwhile: it comes along in its shape, and is not torn there.
#[test]
fn a_paused_cloth_comes_along_when_it_goes_on() {
    for is_attached in [false, true] {
        let mut app = app();
        let pole = app.world_mut().spawn(Transform::default()).id();
        let pins = if is_attached {
            Pins::none()
        } else {
            Pins::new([Pin::Column(0)])
        };
        let cloth = app.world_mut().spawn((Cloth::default(), pins)).id();
        if is_attached {
            let attached = ClothAttachments::new([(Pin::Column(0), pole)]);
            app.world_mut().entity_mut(cloth).insert(attached);
        }
        tick(&mut app, 64);
        app.world_mut().entity_mut(cloth).insert(ClothPaused);
        let before = in_world(&app, cloth);
        let away = Vec3::new(100.0, 5.0, 0.0);
        let carrier = if is_attached { pole } else { cloth };
        for _ in 0..10 {
            change::<Transform>(&mut app, carrier, |place| place.translation += away / 10.0);
            tick(&mut app, 1);
        }
        app.world_mut().entity_mut(cloth).remove::<ClothPaused>();
        tick(&mut app, 1);
        let after = in_world(&app, cloth);
        let speed = particles(&app, cloth).largest_speed();
        let apart = before
            .iter()
            .zip(&after)
            .map(|(a, b)| b.distance(*a + away));
        // In a tick it goes on by its own speed, 100 m away in steps of 8 µm.
        let bound = (speed + GRAVITY * TICK) * TICK + 1.0e-3;
        let farthest = apart.fold(0.0, f32::max);
        assert!(farthest < bound, "{is_attached}: {farthest} {bound}");
        assert!(speed < 20.0, "{is_attached}: {speed} m/s");
    }
}

/// A touch ends as a cloth is paused, and begins again as it goes on.
#[test]
fn a_paused_cloth_touches_nothing() {
    let mut app = app();
    let place = Transform::from_xyz(0.0, 0.02, 0.0);
    let sheet = Cloth::new(9, 9, 0.1).lying().centred();
    let cloth = app.world_mut().spawn((sheet, Pins::none(), place)).id();
    app.world_mut().spawn(ClothCollider::Plane);
    tick(&mut app, 64);
    assert_eq!(messages::<ClothTouchStarted>(&mut app).len(), 1);
    app.world_mut().entity_mut(cloth).insert(ClothPaused);
    tick(&mut app, 10);
    assert_eq!(messages::<ClothTouchStopped>(&mut app).len(), 1);
    app.world_mut().entity_mut(cloth).remove::<ClothPaused>();
    tick(&mut app, 10);
    assert_eq!(messages::<ClothTouchStarted>(&mut app).len(), 1);
}

/// A cloth moves the same, to the last bit, whether it, or what it is a child of, is hidden or not; and its mesh is as it should be
/// as soon as it is seen.
#[test]
fn a_hidden_cloth_moves_on() {
    let mut app = app_that_draws(FixedUpdate);
    let seen = app
        .world_mut()
        .spawn((Cloth::default(), Visibility::default()))
        .id();
    let hidden = app
        .world_mut()
        .spawn((Cloth::default(), Visibility::Hidden))
        .id();
    let below = app
        .world_mut()
        .spawn((Cloth::default(), Visibility::default()))
        .id();
    let above = app
        .world_mut()
        .spawn((Transform::default(), Visibility::Hidden))
        .add_child(below)
        .id();
    tick(&mut app, 40);
    for cloth in [hidden, below] {
        assert_eq!(particles(&app, cloth), particles(&app, seen));
    }
    let drawn = |app: &App, cloth: Entity| {
        let mesh = app.world().get::<Mesh3d>(cloth).expect("a mesh");
        let mesh = app.world().resource::<Assets<Mesh>>().get(&mesh.0);
        let positions = mesh.expect("an asset").attribute(Mesh::ATTRIBUTE_POSITION);
        positions
            .and_then(|values| values.as_float3())
            .expect("positions")
            .to_vec()
    };
    for cloth in [hidden, below] {
        assert_ne!(drawn(&app, cloth), drawn(&app, seen));
    }
    for entity in [hidden, above] {
        app.world_mut()
            .entity_mut(entity)
            .insert(Visibility::Visible);
    }
    tick(&mut app, 1);
    for cloth in [hidden, below] {
        assert_eq!(drawn(&app, cloth), drawn(&app, seen));
    }
}

/// Paused it is drawn, from its first frame on, and not written again.
#[test]
fn a_paused_cloth_is_drawn() {
    let mut app = app_that_draws(FixedUpdate);
    let uneven = Cloth {
        unevenness: 0.1,
        ..default()
    };
    let cloth = (uneven, ClothPaused, Visibility::default());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 3);
    let mesh = app.world().get::<Mesh3d>(cloth).expect("a mesh").0.clone();
    let drawn = app.world().resource::<Assets<Mesh>>().get(&mesh);
    let positions = drawn.expect("an asset").attribute(Mesh::ATTRIBUTE_POSITION);
    let positions = positions
        .and_then(|values| values.as_float3())
        .expect("positions");
    let places: Vec<[f32; 3]> = particles(&app, cloth).positions().map(Into::into).collect();
    assert_eq!(positions, places);
    app.world_mut()
        .resource_mut::<Messages<AssetEvent<Mesh>>>()
        .clear();
    tick(&mut app, 3);
    let events = app
        .world_mut()
        .resource_mut::<Messages<AssetEvent<Mesh>>>()
        .drain()
        .count();
    assert_eq!(events, 0);
}

/// What was a cloth draws what it drew before it was one: its own mesh where it had one, and nothing where it had none.
#[test]
fn what_is_no_cloth_any_more_draws_what_it_drew_before() {
    let mut app = app_that_draws(FixedUpdate);
    let own = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Cuboid::default());
    let with = app
        .world_mut()
        .spawn((Cloth::default(), Mesh3d(own.clone())))
        .id();
    let without = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 3);
    for cloth in [with, without] {
        let drawn = app.world().get::<Mesh3d>(cloth).expect("a mesh").0.clone();
        assert_ne!(drawn, own);
        // A new mesh of the plugin's own is none that the entity had.
        change::<Cloth>(&mut app, cloth, |cloth| *cloth = Cloth::new(9, 9, 0.1));
        tick(&mut app, 3);
        app.world_mut().entity_mut(cloth).remove::<Cloth>();
        tick(&mut app, 1);
    }
    assert_eq!(
        app.world().get::<Mesh3d>(with).map(|mesh| &mesh.0),
        Some(&own)
    );
    assert!(app.world().get::<Mesh3d>(without).is_none());
}
