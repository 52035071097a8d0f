//! Cloths and colliders that are children of something that moves.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    log::{lines_with, listen},
    support::*,
};

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
    // It stands still again.
    tick(&mut app, 3);
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
    // Enabled again where it is, though nothing moves it.
    app.world_mut().entity_mut(ball).remove::<Disabled>();
    tick(&mut app, 1);
    assert!(stats(&app, cloth).contacts > 0);
    // Moved to the cloth, and away from it, while it is disabled.
    app.world_mut().entity_mut(ball).insert(Disabled);
    tick(&mut app, 1);
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
    app.world_mut().entity_mut(ball).insert(Disabled);
    let mut transform = app.world_mut().entity_mut(ball);
    *transform.get_mut::<Transform>().expect("a place") = place;
    tick(&mut app, 5);
    assert_eq!(stats(&app, cloth).contacts, 0);
    app.world_mut().entity_mut(ball).remove::<Disabled>();
    tick(&mut app, 1);
    assert!(stats(&app, cloth).contacts > 0);
    assert!(app.world().get::<ClothFault>(ball).is_none());
    // It appeared there, and did not come: what it comes through has not been swept away.
    let deepest = app.world().get::<ClothContacts>(cloth).expect("contacts");
    let deepest = deepest.with(ball).expect("a touch").deepest_penetration;
    assert!(deepest < 0.3, "{deepest}");
    // Moved beyond it while it is disabled, it has not gone through it.
    app.world_mut().entity_mut(ball).insert(Disabled);
    let mut transform = app.world_mut().entity_mut(ball);
    let mut place = transform.get_mut::<Transform>().expect("a place");
    place.translation.z = -9.0;
    tick(&mut app, 2);
    app.world_mut().entity_mut(ball).remove::<Disabled>();
    tick(&mut app, 1);
    let lowest = particles(&app, cloth).positions().map(|at| at.z);
    let lowest = lowest.fold(0.0, f32::min);
    assert!(lowest > -1.0, "{lowest}");
}

/// A table that is moved by 5 cm takes the cloth on it along by no more than that: it does not go on by itself.
#[test]
fn a_collider_that_stops_has_stopped() {
    let mut app = app();
    let above = Transform::from_xyz(0.0, 0.06, 0.0);
    let cloth = (Cloth::new(9, 9, 0.1).lying().centred(), Pins::none(), above);
    let cloth = app.world_mut().spawn(cloth).id();
    let table = ClothCollider::cuboid(4.0, 0.1, 4.0);
    let table = app.world_mut().spawn((table, Transform::default())).id();
    tick(&mut app, 32);
    let before = position(&app, cloth, (4, 4)).x;
    change::<Transform>(&mut app, table, |place| place.translation.x = 0.05);
    tick(&mut app, 64);
    let gone = position(&app, cloth, (4, 4)).x - before;
    assert!((0.0..0.06).contains(&gone), "{gone}");
}

/// Bevy's `Disabled` does not disable children: a collider below something disabled is met, and moves with it.
#[test]
fn what_is_below_something_disabled_is_met() {
    use bevy::ecs::entity_disabling::Disabled;
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let parent = app
        .world_mut()
        .spawn((Transform::from_xyz(0.0, 0.0, 9.0), Disabled))
        .id();
    let place = Transform::from_xyz(0.75, -1.0, 0.1);
    let ball = (ClothCollider::ball(0.3), place, ChildOf(parent));
    let ball = app.world_mut().spawn(ball).id();
    tick(&mut app, 5);
    assert_eq!(stats(&app, cloth).contacts, 0);
    let mut above = app.world_mut().entity_mut(parent);
    *above.get_mut::<Transform>().expect("a place") = Transform::IDENTITY;
    tick(&mut app, 1);
    assert!(stats(&app, cloth).contacts > 0);
    app.world_mut().entity_mut(parent).remove::<Disabled>();
    tick(&mut app, 1);
    assert!(stats(&app, cloth).contacts > 0);
    assert!(app.world().get::<ClothFault>(ball).is_none());
}

/// A collider that loses its own transform is nowhere, which is said, until it has one again.
#[test]
fn a_collider_without_a_transform_is_named() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let place = Transform::from_xyz(0.75, -1.0, 0.1);
    let ball = (ClothCollider::ball(0.3), place);
    let ball = app.world_mut().spawn(ball).id();
    tick(&mut app, 5);
    assert!(stats(&app, cloth).contacts > 0);
    app.world_mut().entity_mut(ball).remove::<Transform>();
    tick(&mut app, 1);
    let fault = app.world().get::<ClothFault>(ball).expect("a fault");
    assert!(matches!(
        fault.error,
        ClothError::Transform(TransformError::Missing { .. })
    ));
    assert_eq!(stats(&app, cloth).contacts, 0);
    app.world_mut().entity_mut(ball).insert(place);
    tick(&mut app, 1);
    assert!(app.world().get::<ClothFault>(ball).is_none());
    assert!(stats(&app, cloth).contacts > 0);
}

/// Bevy remembers for two frames what has been taken away; the next tick may come later.
#[test]
fn what_is_taken_away_between_ticks_is_noticed() {
    use bevy::time::TimeUpdateStrategy;
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let far = app
        .world_mut()
        .spawn(Transform::from_xyz(0.0, 0.0, 9.0))
        .id();
    let place = Transform::from_xyz(0.75, -1.0, 0.1);
    let ball = (ClothCollider::ball(0.3), place, ChildOf(far));
    let ball = app.world_mut().spawn(ball).id();
    tick(&mut app, 5);
    assert_eq!(stats(&app, cloth).contacts, 0);
    app.world_mut().entity_mut(ball).remove::<ChildOf>();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(
        std::time::Duration::ZERO,
    ));
    (0..5).for_each(|_| app.update());
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    // In the first it is on its way; it stays where it arrives.
    tick(&mut app, 2);
    assert!(stats(&app, cloth).contacts > 0);
}

/// Few colliders below much that moves, as on a skeleton, and many below little: each is found, and at its place.
#[test]
fn colliders_are_found_below_whatever_moves() {
    for (bones, balls) in [(12, 1), (2, 12)] {
        let mut app = app();
        let cloth = app.world_mut().spawn(Cloth::default()).id();
        let root = app
            .world_mut()
            .spawn(Transform::from_xyz(0.0, 0.0, 9.0))
            .id();
        let mut skeleton = vec![root];
        for _ in 0..bones {
            let above = *skeleton.last().expect("the root");
            let bone = (Transform::IDENTITY, ChildOf(above));
            skeleton.push(app.world_mut().spawn(bone).id());
        }
        let hand = *skeleton.last().expect("the root");
        let balls: Vec<Entity> = (0..balls)
            .map(|_| {
                let place = Transform::from_xyz(0.75, -1.0, 0.1);
                let ball = (ClothCollider::ball(0.3), place, ChildOf(hand));
                app.world_mut().spawn(ball).id()
            })
            .collect();
        tick(&mut app, 5);
        assert_eq!(stats(&app, cloth).colliders_near, 0);
        for &bone in &skeleton {
            change::<Transform>(&mut app, bone, |place| place.translation.z = 0.0);
        }
        // In the first they are on their way through the cloth, in the second they are there.
        tick(&mut app, 2);
        assert_eq!(stats(&app, cloth).colliders_near, balls.len());
        change::<Transform>(&mut app, root, |place| place.translation.z = 9.0);
        tick(&mut app, 2);
        assert_eq!(stats(&app, cloth).colliders_near, 0);
    }
}

/// A fault names the parent that has no transform, and ends when that gets one.
#[test]
fn a_parent_without_a_transform_is_named() {
    listen();
    let mut app = app();
    let level = app.world_mut().spawn(Name::new("level")).id();
    let cloth = (Cloth::default(), Name::new("drape"), ChildOf(level));
    let cloth = app.world_mut().spawn(cloth).id();
    let node = (Transform::default(), ChildOf(level));
    let node = app.world_mut().spawn(node).id();
    let ball = (ClothCollider::default(), Name::new("globe"), ChildOf(node));
    let ball = app.world_mut().spawn(ball).id();
    tick(&mut app, 3);
    let remedy = "has no `Transform`: insert one, such as `Transform::default()`";
    let out = "is left out of the cloth simulation";
    let mut lines = lines_with("\"level\"");
    lines.sort();
    assert_eq!(
        lines,
        [
            format!("cloth \"drape\" {out}: the parent \"level\" {remedy}"),
            format!("cloth collider \"globe\" {out}: the ancestor \"level\" {remedy}"),
        ]
    );
    app.world_mut()
        .entity_mut(level)
        .insert(Transform::default())
        .remove::<Name>();
    tick(&mut app, 3);
    for entity in [cloth, ball] {
        assert!(app.world().get::<ClothFault>(entity).is_none());
    }
    app.world_mut().entity_mut(level).remove::<Transform>();
    tick(&mut app, 1);
    let fault = app.world().get::<ClothFault>(cloth).expect("a fault");
    assert_eq!(
        fault.error.to_string(),
        format!("the parent {level} {remedy}")
    );
}

/// A disabled parent has its transform still: what is below it is not disabled.
#[test]
fn a_cloth_below_something_disabled_moves() {
    use bevy::ecs::entity_disabling::Disabled;
    let mut app = app();
    let parent = (Transform::from_xyz(0.0, 3.0, 0.0), Disabled);
    let parent = app.world_mut().spawn(parent).id();
    let cloth = (Cloth::default(), Pins::none(), ChildOf(parent));
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 5);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    assert!(position(&app, cloth, (0, 0)).y < -0.01);
}
