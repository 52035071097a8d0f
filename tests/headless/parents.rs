//! Cloths and colliders that are children of something that moves.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// Where something is in a tick: on its way, turning.
fn at(tick: u32) -> Transform {
    let part = tick as f32 / 64.0;
    Transform::from_xyz(0.6 * part, 0.1 * (3.0 * part).sin(), 0.0)
        .with_rotation(Quat::from_rotation_y(0.8 * part))
}

/// A cape: a cloth that is pinned to the collider that it is a child of moves as one that is a child of something else which
/// goes the same way as the collider does.
#[test]
fn a_cloth_may_be_a_child_of_what_it_touches() {
    let run = |is_one: bool| {
        let mut app = app();
        let parent = app.world_mut().spawn(at(0)).id();
        let collider = if is_one {
            parent
        } else {
            app.world_mut().spawn(at(0)).id()
        };
        app.world_mut()
            .entity_mut(collider)
            .insert(ClothCollider::ball(0.4));
        let cape = Transform::from_xyz(-0.5, 0.3, 0.35);
        let cape = (Cloth::new(12, 12, 0.08), cape, ChildOf(parent));
        let cape = app.world_mut().spawn(cape).id();
        let mut contacts = 0;
        for count in 1..200 {
            for entity in [parent, collider] {
                change::<Transform>(&mut app, entity, |place| *place = at(count));
            }
            tick(&mut app, 1);
            contacts += stats(&app, cape).contacts;
        }
        assert!(contacts > 100, "{contacts}");
        assert!(app.world().get::<ClothFault>(cape).is_none());
        particles(&app, cape).clone()
    };
    assert_eq!(run(true), run(false));
}

/// A collider that stands still on something that moves moves with it; one that no longer does rests.
#[test]
fn a_collider_follows_what_is_above_it() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let root = app.world_mut().spawn(Transform::default()).id();
    let limb = (Transform::from_xyz(0.75, 0.0, -9.0), ChildOf(root));
    let limb = app.world_mut().spawn(limb).id();
    let ball = (
        ClothCollider::ball(0.4),
        Transform::from_xyz(0.0, -1.0, 0.0),
        ChildOf(limb),
    );
    let ball = app.world_mut().spawn(ball).id();
    tick(&mut app, 20);
    let touches = |app: &App| {
        let contacts = app.world().get::<ClothContacts>(cloth);
        contacts.expect("contacts").with(ball).is_some()
    };
    assert!(!touches(&app));
    // To the cloth, by its grandparent.
    change::<Transform>(&mut app, root, |place| place.translation.z = 9.0);
    tick(&mut app, 1);
    assert!(touches(&app));
    // Away from it, by being put under nothing; and not back by a parent without a place.
    app.world_mut().entity_mut(limb).remove::<ChildOf>();
    tick(&mut app, 120);
    assert!(!touches(&app));
    app.world_mut().entity_mut(limb).insert(ChildOf(root));
    app.world_mut().entity_mut(root).remove::<Transform>();
    tick(&mut app, 1);
    assert!(app.world().get::<ClothFault>(ball).is_some());
    app.world_mut()
        .entity_mut(root)
        .insert(Transform::default());
    tick(&mut app, 120);
    assert!(app.world().get::<ClothFault>(ball).is_none());
    assert!(!touches(&app));
}

/// A collider that is disabled is not there; enabled again, it is where it has been moved to meanwhile, without a speed.
#[test]
fn a_disabled_collider_is_not_met() {
    use bevy::ecs::entity_disabling::Disabled;
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let place = Transform::from_xyz(0.75, -1.0, 0.1);
    let ball = app
        .world_mut()
        .spawn((ClothCollider::ball(0.3), place))
        .id();
    tick(&mut app, 30);
    assert!(stats(&app, cloth).contacts > 0);
    app.world_mut().entity_mut(ball).insert(Disabled);
    tick(&mut app, 1);
    assert_eq!(stats(&app, cloth).contacts, 0);
    let mut transform = app.world_mut().entity_mut(ball);
    transform
        .get_mut::<Transform>()
        .expect("a place")
        .translation
        .z = 9.0;
    tick(&mut app, 5);
    app.world_mut().entity_mut(ball).remove::<Disabled>();
    tick(&mut app, 30);
    assert_eq!(stats(&app, cloth).contacts, 0);
    change::<Transform>(&mut app, ball, |transform| *transform = place);
    tick(&mut app, 1);
    assert!(stats(&app, cloth).contacts > 0);
}
