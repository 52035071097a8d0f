//! What is near a cloth, and what is not.

use bevy::prelude::*;
use bevy_drape::{hierarchy::SearchReason, prelude::*};

use crate::support::*;

/// A fast ball drags the cloth, within one tick, to a wall that is far beyond what the cloth could reach by itself.
#[test]
fn what_a_ball_drags_the_cloth_to_is_found() {
    let mut app = app_with_moving_balls();
    let cloth = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
    // A collider's first way is known from its second tick on, in which it goes 3.1 m.
    let place = Transform::from_xyz(0.75, -0.75, -4.0);
    let ball = (ClothCollider::ball(0.3), Moving(200.0), place);
    let ball = app.world_mut().spawn(ball).id();
    let wall = ClothCollider::cuboid(1.0, 1.0, 0.2);
    let place = Transform::from_xyz(0.75, -0.75, 2.6);
    // Of the ball's kind, so that its turn is after the ball's in each sub-step.
    let wall = app.world_mut().spawn((wall, Moving(0.0), place)).id();
    tick(&mut app, 2);
    let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
    assert!(
        contacts.with(ball).is_some() && contacts.with(wall).is_some(),
        "{contacts:?}"
    );
}

/// The ground is below, all of it, but not near.
#[test]
fn a_plane_far_below_is_not_near() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let ground = (ClothCollider::plane(), Transform::from_xyz(0.0, -9.0, 0.0));
    let ground = app.world_mut().spawn(ground).id();
    tick(&mut app, 5);
    assert_eq!(stats(&app, cloth).reason, SearchReason::NothingNear);
    change::<Transform>(&mut app, ground, |place| place.translation.y = -1.3);
    tick(&mut app, 1);
    assert_ne!(stats(&app, cloth).reason, SearchReason::NothingNear);
    assert!(stats(&app, cloth).contacts > 0);
}

/// A slope that stands still does not turn, not even by a rounding: it is no nearer than a level plane.
#[test]
fn a_slope_far_below_is_not_near() {
    for step in 0..20 {
        let mut app = app();
        let cloth = app.world_mut().spawn(Cloth::default()).id();
        let tilt = 0.045 * step as f32;
        let rotation = Quat::from_rotation_z(tilt) * Quat::from_rotation_x(0.7 * tilt);
        let slope = Transform::from_xyz(0.0, -9.0, 0.0).with_rotation(rotation);
        app.world_mut().spawn((ClothCollider::plane(), slope));
        tick(&mut app, 3);
        let reason = stats(&app, cloth).reason;
        assert_eq!(reason, SearchReason::NothingNear, "{tilt}");
    }
}

/// A cloth that is built again, larger, in the very tick in which something else is wrong with it, is not searched by the
/// volumes of what it was.
#[test]
fn a_cloth_at_fault_is_not_searched() {
    for method in SearchMethod::ALL {
        let mut app = app();
        let target = app.world_mut().spawn(Transform::default()).id();
        let attached = ClothAttachments::new([(Pin::Cell(0, 0), target)]);
        let cloth = (Cloth::new(8, 8, 0.1), attached, method);
        let cloth = app.world_mut().spawn(cloth).id();
        let ball = (
            ClothCollider::ball(0.4),
            Transform::from_xyz(0.3, -0.4, 0.3),
        );
        app.world_mut().spawn(ball);
        tick(&mut app, 5);
        change::<Cloth>(&mut app, cloth, |cloth| *cloth = Cloth::new(40, 30, 0.1));
        app.world_mut().despawn(target);
        tick(&mut app, 3);
        assert!(app.world().get::<ClothFault>(cloth).is_some(), "{method}");
        app.world_mut()
            .entity_mut(cloth)
            .remove::<ClothAttachments>();
        tick(&mut app, 3);
        assert!(app.world().get::<ClothFault>(cloth).is_none(), "{method}");
        assert_eq!(particles(&app, cloth).len(), 1200);
    }
}
