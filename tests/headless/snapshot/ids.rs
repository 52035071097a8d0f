//! Snapshots in worlds whose entities have other ids.

use bevy::{
    ecs::entity::{EntityHashMap, MapEntities},
    prelude::*,
};
use bevy_drape::prelude::*;

use super::{
    Seen, compare, forget_messages, next,
    scene::{Clock, everything, everything_after},
};
use crate::support::*;

/// The entities with a transform, in the order in which they were spawned.
fn places(app: &mut App) -> Vec<Entity> {
    let mut places = app
        .world_mut()
        .query_filtered::<Entity, With<Transform>>()
        .iter(app.world())
        .collect::<Vec<_>>();
    places.sort_unstable_by_key(|entity| entity.index_u32());
    places
}

/// What is seen of the same tick where entities have other ids.
fn elsewhere(mut seen: Seen, ids: &mut EntityHashMap<Entity>) -> Seen {
    for (_, contacts, _) in &mut seen.cloths {
        contacts.iter_mut().for_each(|of| of.map_entities(ids));
    }
    for (cloth, collider) in seen.began.iter_mut().chain(&mut seen.ended) {
        (*cloth, *collider) = (ids[cloth], ids[collider]);
    }
    seen
}

/// From a file, in a world in which all entities have other ids.
#[test]
fn a_world_with_other_ids_goes_on_to_the_last_bit() {
    let (mut app, cloths) = everything();
    tick(&mut app, 40);
    let saved = ClothWorldSnapshot::of(app.world_mut());
    let clock = *app.world().resource::<Clock>();
    let before = places(&mut app);
    forget_messages(&mut app);
    let seen: Vec<Seen> = (0..100).map(|_| next(&mut app, &cloths)).collect();
    assert!(seen.iter().any(|seen| !seen.began.is_empty()));
    const OTHERS: usize = 1000;
    let (mut other, others) = everything_after(OTHERS);
    let after = places(&mut other).split_off(OTHERS);
    assert_eq!(before.len(), after.len());
    let mut ids: EntityHashMap<Entity> = before.into_iter().zip(after).collect();
    let text = ron::to_string(&saved).expect("it can be written");
    let mut read: ClothWorldSnapshot = ron::from_str(&text).expect("it can be read");
    let known: Vec<Entity> = read.entities().collect();
    assert!(known.iter().all(|entity| ids.contains_key(entity)));
    assert!(cloths.iter().all(|cloth| known.contains(cloth)));
    // As the file has them they are others.
    let error = read.restore(other.world_mut()).expect_err("other ids");
    assert!(matches!(error, SnapshotError::NoCloth { entity } if cloths.contains(&entity)));
    read.map_entities(&mut ids);
    read.restore(other.world_mut()).expect("the same entities");
    other.insert_resource(clock);
    let seen: Vec<Seen> = seen
        .into_iter()
        .map(|seen| elsewhere(seen, &mut ids))
        .collect();
    compare(&seen, &mut other, &others, "with other ids");
}

/// Two layers that lie on a box, of which one hangs on a pole too, and a ball: spawned in this order or the other way round.
fn layers(is_reversed: bool) -> (App, Vec<Entity>) {
    let mut app = app();
    let world = app.world_mut();
    let mut spawn: [Box<dyn Fn(&mut World) -> Entity>; 5] = [
        Box::new(|world| {
            let pole = (Name::new("pole"), Transform::from_xyz(0.3, 0.1, 0.3));
            world.spawn(pole).id()
        }),
        Box::new(|world| {
            let box_ = ClothCollider::cuboid(0.2, 0.1, 0.2);
            world.spawn((box_, Transform::from_xyz(0.0, 0.1, 0.0))).id()
        }),
        Box::new(|world| {
            let ball = ClothCollider::ball(0.1);
            world.spawn((ball, Transform::from_xyz(0.1, 0.2, 0.0))).id()
        }),
        Box::new(|world| {
            let hangs = ClothAttachments::new([(Pin::Corner(Corner::BottomRight), "pole")]);
            world.spawn((layer(0.36), hangs)).id()
        }),
        Box::new(|world| world.spawn(layer(0.42)).id()),
    ];
    if is_reversed {
        spawn.reverse();
    }
    let mut all: Vec<Entity> = spawn.iter().map(|spawn| spawn(world)).collect();
    if is_reversed {
        all.reverse();
    }
    (app, all)
}

fn layer(height: f32) -> impl Bundle {
    (
        Cloth::new(12, 12, 0.05).lying().centred(),
        Pins::none(),
        ClothSelfCollision::default(),
        Transform::from_xyz(0.0, height, 0.0),
    )
}

/// Contacts between cloths, and with colliders, are resolved in an order that does not depend on ids.
#[test]
fn ids_may_be_in_another_order() {
    let (mut app, before) = layers(false);
    let (mut other, after) = layers(true);
    tick(&mut app, 30);
    let mut saved = ClothWorldSnapshot::of(app.world_mut());
    let mut ids: EntityHashMap<Entity> = before.iter().copied().zip(after.clone()).collect();
    saved.map_entities(&mut ids);
    saved.restore(other.world_mut()).expect("the same entities");
    for ticks in 1..100 {
        tick(&mut app, 1);
        tick(&mut other, 1);
        for (cloth, twin) in before.iter().zip(&after).skip(3) {
            assert!(other.world().get::<ClothFault>(*twin).is_none());
            let [a, b] = [particles(&app, *cloth), particles(&other, *twin)];
            assert!(a == b, "{ticks} ticks on");
        }
    }
}
