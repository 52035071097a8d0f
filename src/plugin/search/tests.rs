//! The tree of colliders against a scan of all of them.

use bevy::{
    ecs::{entity_disabling::Disabled, hierarchy::ChildOf, system::RunSystemOnce},
    prelude::*,
    time::TimeUpdateStrategy,
};
use proptest::prelude::*;

use super::*;
use crate::{
    cloth::Cloth,
    contact::ClothCollider,
    plugin::{sets::ClothSystems, simulation::ClothPlugin},
};

/// What a game does to a collider between two ticks.
#[derive(Debug, Clone)]
enum Change {
    Spawn(ClothCollider, Option<usize>),
    Move(Vec3),
    Turn(Vec3),
    Scale(f32),
    Layers(ClothLayers),
    NoLayers,
    Reparent(Option<usize>),
    Disable,
    Enable,
    Remove,
    InsertAgain,
    Despawn,
    Break,
}

fn places() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-6.0_f32..6.0).prop_map(Vec3::from)
}

fn changes() -> impl Strategy<Value = Change> {
    let lengths = || 0.05_f32..1.5;
    let parents = || prop::option::of(0_usize..2);
    let colliders = prop_oneof![
        lengths().prop_map(ClothCollider::ball),
        (lengths(), lengths()).prop_map(|(r, l)| ClothCollider::capsule(r, l)),
        (lengths(), lengths(), lengths()).prop_map(|(x, y, z)| ClothCollider::cuboid(x, y, z)),
        Just(ClothCollider::plane()),
    ];
    let masks = || prop_oneof![Just(0_u32), Just(0b1), Just(0b11), Just(u32::MAX)];
    prop_oneof![
        4 => (colliders, parents()).prop_map(|(collider, parent)| Change::Spawn(collider, parent)),
        4 => places().prop_map(Change::Move),
        2 => places().prop_map(Change::Turn),
        1 => lengths().prop_map(Change::Scale),
        1 => (masks(), masks()).prop_map(|(a, b)| Change::Layers(ClothLayers::new(a, b))),
        1 => Just(Change::NoLayers),
        1 => parents().prop_map(Change::Reparent),
        1 => Just(Change::Disable),
        1 => Just(Change::Enable),
        1 => Just(Change::Remove),
        1 => Just(Change::InsertAgain),
        1 => Just(Change::Despawn),
        1 => Just(Change::Break),
    ]
}

fn make(world: &mut World, entity: Entity, change: Change, parents: [Entity; 2]) {
    let reparent = |world: &mut World, parent: Option<usize>| {
        let mut entity = world.entity_mut(entity);
        match parent {
            Some(parent) => entity.insert(ChildOf(parents[parent])),
            None => entity.remove::<ChildOf>(),
        };
    };
    let with_place = |world: &mut World, change: &dyn Fn(&mut Transform)| {
        change(&mut world.get_mut::<Transform>(entity).expect("a transform"));
    };
    match change {
        Change::Spawn(collider, parent) => {
            world.entity_mut(entity).insert(collider);
            reparent(world, parent);
        }
        Change::Move(place) => with_place(world, &|transform| transform.translation = place),
        Change::Turn(axis) => with_place(world, &|transform| {
            transform.rotation = Quat::from_scaled_axis(axis);
        }),
        Change::Scale(scale) => {
            with_place(world, &|transform| transform.scale = Vec3::splat(scale));
        }
        Change::Break => with_place(world, &|transform| transform.translation.y = f32::NAN),
        Change::Layers(layers) => {
            world.entity_mut(entity).insert(layers);
        }
        Change::NoLayers => {
            world.entity_mut(entity).remove::<ClothLayers>();
        }
        Change::Reparent(parent) => reparent(world, parent),
        Change::Disable => {
            world.entity_mut(entity).insert(Disabled);
        }
        Change::Enable => {
            world.entity_mut(entity).remove::<Disabled>();
        }
        Change::Remove => {
            world.entity_mut(entity).remove::<ClothCollider>();
        }
        Change::InsertAgain => {
            if let Some(collider) = world.get::<ClothCollider>(entity).cloned() {
                world.entity_mut(entity).insert(collider);
            }
        }
        Change::Despawn => {
            world.despawn(entity);
        }
    }
}

type Scanned = (
    Entity,
    &'static ColliderMotion,
    Option<&'static ClothLayers>,
    Option<&'static ClothOrder>,
);

/// What a scan of all colliders finds near a cloth, as far as they drag it to others, in their order.
fn scanned(cloth: &SearchQueryReadOnlyItem, colliders: &Query<Scanned>) -> Vec<Entity> {
    let BroadPhaseBounds { centre, radius, .. } = *cloth.broad_phase;
    let root = cloth
        .built
        .tree()
        .root_sphere(cloth.particles, cloth.state.stretch.bound);
    let mut dragged = 0.0_f32;
    loop {
        let mut farthest = 0.0_f32;
        let mut found = Vec::new();
        for (entity, motion, layers, order) in colliders {
            let layers = layers.copied().unwrap_or_default();
            if layers.interacts_with(cloth.layers.copied().unwrap_or_default())
                && motion.comes_near(centre, radius + dragged)
                && let Some(near) = motion.seen_from(cloth.frame, None)
            {
                farthest = farthest.max(near.max_surface_travel(near.farthest_distance(&root)));
                found.push((order.copied(), entity));
            }
        }
        if farthest <= dragged || !farthest.is_finite() {
            found.sort_unstable();
            return found.into_iter().map(|(_, entity)| entity).collect();
        }
        dragged = farthest;
    }
}

/// What each cloth found in the tick, and what a scan finds.
#[derive(Resource, Default)]
struct Found(Vec<(Vec<Entity>, Vec<Entity>)>);

/// Scans for each cloth that has looked around, before anything moves it: a collider may throw it far within the tick.
fn scan(cloths: Query<SearchQuery>, colliders: Query<Scanned>, mut found: ResMut<Found>) {
    found.0 = cloths
        .iter()
        .map(|cloth| {
            let scanned = scanned(&cloth, &colliders);
            // What has nothing near does not look around, and keeps the list that it had.
            let near = cloth.scratch.near.iter().map(|(entity, _)| *entity);
            let near = near.filter(|_| cloth.broad_phase.is_searched).collect();
            (near, scanned)
        })
        .collect();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever a game does to its colliders and to what they are children of, each cloth finds what a scan finds, and each
    /// collider is where its transform says.
    #[test]
    fn what_is_near_is_what_a_scan_finds(
        ticks in prop::collection::vec(
            (prop::collection::vec((0_usize..12, changes()), 0..12), prop::option::of(places())),
            1..12,
        ),
    ) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, ClothPlugin::default()))
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
            .init_resource::<Found>()
            .add_systems(
                FixedUpdate,
                scan.after(ClothSystems::Rebuild).before(ClothSystems::Query),
            );
        app.finish();
        app.cleanup();
        app.update();
        let world = app.world_mut();
        let parents = [(); 2].map(|()| world.spawn(Transform::default()).id());
        for x in [-3.0, 0.0, 3.0] {
            let place = Transform::from_xyz(x, 1.0, 0.0);
            world.spawn((Cloth::new(6, 6, 0.2), ClothLayers::new(0b1, 0b11), place));
        }
        let mut entities = [(); 12].map(|()| world.spawn(Transform::default()).id());
        for (changes, parent) in ticks {
            let world = app.world_mut();
            for (which, change) in changes {
                let is_gone = matches!(change, Change::Despawn);
                make(world, entities[which], change, parents);
                if is_gone {
                    entities[which] = world.spawn(Transform::default()).id();
                }
            }
            if let Some(place) = parent {
                world.entity_mut(parents[0]).insert(Transform::from_translation(place));
            }
            app.update();
            let found = std::mem::take(&mut app.world_mut().resource_mut::<Found>().0);
            let look = |colliders: Query<(Entity, &ColliderMotion)>, transforms: TransformHelper| {
                let places = colliders.iter().filter_map(|(entity, motion)| {
                    let place = transforms.compute_global_transform(entity).ok()?;
                    // What is nowhere has no way, and each other has one.
                    let is_somewhere = place.affine().is_finite();
                    let moving = motion.seen_from(&ClothFrame::default(), None);
                    Some((is_somewhere, moving, place.translation()))
                });
                places.collect::<Vec<_>>()
            };
            let places = app
                .world_mut()
                .run_system_once(look)
                .expect("the system runs");
            for (near, scanned) in found {
                prop_assert_eq!(near, scanned);
            }
            for (is_somewhere, moving, place) in places {
                prop_assert_eq!(moving.is_some(), is_somewhere, "{:?} at {}", moving, place);
                if let Some(moving) = moving {
                    prop_assert_eq!(moving.to, place);
                }
            }
        }
    }
}
