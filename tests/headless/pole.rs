//! A flag whose pole is a collider.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// Radius of the pole (m).
const RADIUS: f32 = 0.02;

/// A flag that streams along +x in a wind of its own gravity, attached to a pole by its left column; its cells are wider than the pole
/// reaches.
fn flag(app: &mut App, collider: ClothCollider, gravity: Vec3) -> (Entity, Entity) {
    let pole = app.world_mut().spawn((Transform::default(), collider)).id();
    let attached = ClothAttachments::new([(Pin::Column(0), pole)]);
    let settings = ClothSettings {
        gravity: Some(gravity),
        sleeps: false,
        ..default()
    };
    let cloth = (Cloth::new(16, 12, 0.06), Pins::none(), attached, settings);
    (app.world_mut().spawn(cloth).id(), pole)
}

/// What is pinned to the pole inside of it is no touch, as nothing can bring it out: it moves as if there were no collider, to the last
/// bit, of second order and without a push in any sub-step.
#[test]
fn a_flag_is_not_pushed_by_the_pole_that_it_is_attached_to() {
    for collider in [
        ClothCollider::capsule(RADIUS, 3.0),
        ClothCollider::cylinder(RADIUS, 3.0),
    ] {
        let gravity = Vec3::new(9.81, -3.0, 1.0);
        let mut app = app();
        let (cloth, pole) = flag(&mut app, collider.clone(), gravity);
        let (alone, other) = flag(&mut app, collider.clone(), gravity);
        app.world_mut()
            .entity_mut(other)
            .remove::<ClothCollider>()
            .insert(Transform::default());
        let layer = ClothLayers::NONE;
        app.world_mut().entity_mut(alone).insert(layer);
        tick(&mut app, 128);
        assert_eq!(messages::<ClothTouchStarted>(&mut app), [], "{collider:?}");
        assert_eq!(particles(&app, cloth), particles(&app, alone));
        assert!(app.world().get::<ClothCollider>(pole).is_some());
    }
}

/// But what is pinned elsewhere is met: a second pole, which the wind presses the flag against.
#[test]
fn a_flag_is_held_back_by_another_pole() {
    let mut app = app();
    let pole = ClothCollider::capsule(RADIUS, 3.0);
    let (cloth, _) = flag(&mut app, pole.clone(), Vec3::new(9.81, 0.0, 5.0));
    let place = Transform::from_xyz(0.4, 0.0, 0.1);
    let second = app.world_mut().spawn((pole, place)).id();
    tick(&mut app, 128);
    let touched = messages::<ClothTouchStarted>(&mut app);
    let by_second = |touch: &ClothTouchStarted| (touch.cloth, touch.collider) == (cloth, second);
    assert!(!touched.is_empty() && touched.iter().all(by_second));
    // Where it would stream without that, at atan(5 ⁄ 9.81) from the x-axis, is behind the pole.
    let side = position(&app, cloth, (6, 6)).z;
    assert!(side < 0.1, "{side} m");
}
