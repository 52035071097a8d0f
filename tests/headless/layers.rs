//! Which cloths meet which colliders.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A sheet that falls flat on a plane of the ground.
fn spawn_sheet(app: &mut App) -> (Entity, Entity) {
    let flat = Transform::from_xyz(0.0, 0.1, 0.0)
        .with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let sheet = (Cloth::new(8, 8, 0.1), Pins::none(), flat);
    let sheet = app.world_mut().spawn(sheet).id();
    let ground = app.world_mut().spawn(ClothCollider::plane()).id();
    (sheet, ground)
}

fn height(app: &App, cloth: Entity) -> f32 {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    frame.to_world(position(app, cloth, (3, 3))).y
}

/// Both must agree, and what neither names is all.
#[test]
fn layers_that_agree_touch() {
    let [first, second] = [0b01, 0b10];
    for (of_cloth, of_collider, touches) in [
        (None, None, true),
        (Some(ClothLayers::new(first, second)), None, true),
        (None, Some(ClothLayers::new(first, second)), true),
        (
            Some(ClothLayers::new(first, second)),
            Some(ClothLayers::new(second, first)),
            true,
        ),
        (
            Some(ClothLayers::new(first, second)),
            Some(ClothLayers::new(first, u32::MAX)),
            false,
        ),
        (
            Some(ClothLayers::new(first, second)),
            Some(ClothLayers::new(second, second)),
            false,
        ),
        (Some(ClothLayers::new(u32::MAX, 0)), None, false),
        (None, Some(ClothLayers::NONE), false),
    ] {
        let mut app = app();
        let (sheet, ground) = spawn_sheet(&mut app);
        for (entity, layers) in [(sheet, of_cloth), (ground, of_collider)] {
            if let Some(layers) = layers {
                app.world_mut().entity_mut(entity).insert(layers);
            }
        }
        tick(&mut app, 60);
        assert_eq!(
            height(&app, sheet) > 0.0,
            touches,
            "{of_cloth:?} {of_collider:?}"
        );
        let started = messages::<ClothTouchStarted>(&mut app);
        assert_eq!(!started.is_empty(), touches);
        for entity in [sheet, ground] {
            assert!(app.world().get::<ClothFault>(entity).is_none());
        }
    }
}

/// Cloth that a fast ball drives, within one tick, to a wall that is far beyond what it could reach by itself meets that as its layers
/// say.
#[test]
fn what_is_driven_far_keeps_to_its_layers() {
    for (layers, touches) in [(ClothLayers::ALL, true), (ClothLayers::NONE, false)] {
        let mut app = app_with_moving_balls();
        let cloth = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
        // A collider's first way is known from its second tick on, in which it goes 3.1 m.
        let place = Transform::from_xyz(0.75, -0.75, -4.0);
        let ball = (ClothCollider::ball(0.3), Moving(200.0), place);
        let ball = app.world_mut().spawn(ball).id();
        let wall = ClothCollider::cuboid(1.0, 1.0, 0.2);
        let place = Transform::from_xyz(0.75, -0.75, 2.6);
        // Of the ball's kind, so that its turn is after the ball's in each sub-step.
        let wall = app
            .world_mut()
            .spawn((wall, Moving(0.0), place, layers))
            .id();
        tick(&mut app, 2);
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        assert!(contacts.with(ball).is_some(), "{contacts:?}");
        assert_eq!(contacts.with(wall).is_some(), touches, "{contacts:?}");
    }
}

/// A sleeping cloth falls once it may no longer touch what it lies on; one in which something stands that it now meets
/// wakes.
#[test]
fn a_change_of_layers_wakes() {
    let mut app = app();
    let (sheet, ground) = spawn_sheet(&mut app);
    let place = Transform::from_xyz(0.35, 0.0, 0.35);
    let ghost = (ClothCollider::ball(0.2), ClothLayers::NONE, place);
    let ghost = app.world_mut().spawn(ghost).id();
    let mut ticks = 0;
    while !stats(&app, sheet).is_asleep {
        tick(&mut app, 1);
        ticks += 1;
        assert!(ticks < 2_000, "it never sleeps");
    }
    tick(&mut app, 5);
    assert!(stats(&app, sheet).is_asleep);
    app.world_mut().entity_mut(ghost).remove::<ClothLayers>();
    tick(&mut app, 1);
    assert!(!stats(&app, sheet).is_asleep);
    app.world_mut().entity_mut(ghost).insert(ClothLayers::NONE);
    ticks = 0;
    while !stats(&app, sheet).is_asleep {
        tick(&mut app, 1);
        ticks += 1;
        assert!(ticks < 2_000, "it never sleeps again");
    }
    app.world_mut().entity_mut(ground).insert(ClothLayers::NONE);
    tick(&mut app, 60);
    assert!(height(&app, sheet) < -1.0, "{}", height(&app, sheet));
    assert_eq!(messages::<ClothTouchStopped>(&mut app).len(), 2);
}
