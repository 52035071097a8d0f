//! Neither the order of spawning nor unrelated entities change a bit.

use bevy::{ecs::system::RunSystemOnce, prelude::*};
use bevy_drape::prelude::*;

use crate::{fuzz::random::Random, support::*};

/// The number of an entity in its scene.
#[derive(Component, Clone, Copy)]
struct Number(usize);

type Spawn = Box<dyn Fn(&mut World) -> Entity>;

fn spawn(bundle: impl Bundle + Clone) -> Spawn {
    Box::new(move |world| world.spawn(bundle.clone()).id())
}

/// Layers on a box, on three balls, and on each other; a plank on two cloths; a flag before two fans; cloths at lower rates.
fn scene() -> Vec<Spawn> {
    let at = Transform::from_xyz;
    let layer = |place: Transform| {
        (
            Cloth::new(10, 10, 0.05).lying().centred(),
            Pins::none(),
            ClothSelfCollision::default(),
            place,
        )
    };
    let rare = |place: Transform| {
        let lod = ClothLod::at(ClothLodLevel::Every(4));
        (Cloth::new(6, 6, 0.1), lod, place)
    };
    let pressed = (
        Cloth::new(16, 16, 0.05).lying().centred(),
        Pins::filter(|row, column| row % 15 == 0 || column % 15 == 0),
    );
    let fan = |place: Transform, velocity| (ClothWindZone::ball(1.0, velocity), place);
    let ball = |place: Transform| (ClothCollider::ball(0.1), place);
    let plank = (
        ClothCollider::cuboid(0.5, 0.03, 0.1),
        ClothBody::new(0.2, Vec3::splat(0.01)),
    );
    vec![
        spawn((layer(at(0.0, 0.36, 0.0)), Name::new("upper"))),
        spawn(layer(at(0.02, 0.32, 0.0))),
        spawn((ClothCollider::cuboid(0.2, 0.1, 0.2), at(0.0, 0.1, 0.0))),
        spawn(ball(at(0.1, 0.2, 0.0))),
        spawn(ball(at(-0.1, 0.2, 0.05))),
        spawn((pressed.clone(), at(5.0, 0.0, 0.0))),
        spawn((pressed, at(5.8, 0.0, 0.0))),
        spawn((plank, at(5.4, 0.1, 0.0))),
        spawn((Cloth::new(12, 8, 0.1), at(10.0, 0.0, 0.0))),
        spawn(fan(at(10.0, -0.5, -0.5), Vec3::new(0.3, 0.0, 5.0))),
        spawn(fan(at(10.5, -0.5, 0.5), Vec3::new(-4.0, 1.0, -3.0))),
        spawn((rare(at(20.0, 0.0, 0.0)), ClothSelfCollision::default())),
        spawn((rare(at(20.0, 0.0, 0.1)), ClothSelfCollision::default())),
        spawn(rare(at(25.0, 0.0, 0.0))),
    ]
}

/// Positions of all cloths, and of what they push, by number.
fn seen(app: &mut App) -> Vec<(usize, Vec<[u32; 3]>)> {
    let bits = |place: Vec3| place.to_array().map(f32::to_bits);
    let world = app.world_mut();
    let mut cloths = world.query::<(&Number, &ClothParticles)>();
    let cloths = cloths.iter(world);
    let mut all: Vec<_> = cloths
        .map(|(number, particles)| (number.0, particles.positions().map(bits).collect()))
        .collect();
    let mut bodies = world.query_filtered::<(&Number, &Transform), With<ClothBody>>();
    all.extend(
        (bodies.iter(world)).map(|(number, place)| (number.0, vec![bits(place.translation)])),
    );
    all.sort();
    all
}

/// Spawned in this order, each after so many entities that have nothing to do with cloth, of which every second is gone.
fn run(
    order: &[usize],
    others: &mut dyn FnMut() -> usize,
    ticks: usize,
) -> Vec<Vec<(usize, Vec<[u32; 3]>)>> {
    let mut app = app();
    let scene = scene();
    for &number in order {
        for other in 0..others() {
            let other = app.world_mut().spawn((
                Name::new("another"),
                Transform::from_xyz(0.0, other as f32, 0.0),
            ));
            let other = other.id();
            if other.index_u32().is_multiple_of(2) {
                app.world_mut().despawn(other);
            }
        }
        let entity = scene[number](app.world_mut());
        app.world_mut().entity_mut(entity).insert(Number(number));
    }
    (0..ticks)
        .map(|_| {
            tick(&mut app, 1);
            assert_sound(&mut app);
            seen(&mut app)
        })
        .collect()
}

fn assert_sound(app: &mut App) {
    let faults = |faults: Query<&ClothFault>| faults.iter().count();
    let faults = app.world_mut().run_system_once(faults).expect("a query");
    assert_eq!(faults, 0);
}

#[test]
fn the_order_of_spawning_changes_no_bit() {
    let straight: Vec<usize> = (0..scene().len()).collect();
    let ticks = if is_long() { 300 } else { 100 };
    let expected = run(&straight, &mut || 0, ticks);
    // It is worth the name: the plank was moved.
    assert_ne!(expected[0].last(), expected[ticks - 1].last());
    let mut random = Random(27);
    for round in 0..if is_long() { 20 } else { 4 } {
        let mut order = straight.clone();
        for last in (1..order.len()).rev() {
            order.swap(last, random.below(last + 1));
        }
        let found = run(&order, &mut || random.below(4), ticks);
        for (tick, (expected, found)) in expected.iter().zip(&found).enumerate() {
            for (expected, found) in expected.iter().zip(found) {
                assert_eq!(expected.0, found.0);
                let differ = expected.1.iter().zip(&found.1).filter(|(a, b)| a != b);
                assert_eq!(
                    differ.count(),
                    0,
                    "number {} in tick {tick}, spawned in the order {order:?}, round {round}",
                    expected.0
                );
            }
        }
    }
}

/// A game's own order goes before names and places, and an entity keeps the order that it got.
#[test]
fn a_game_may_set_the_order() {
    let mut app = app();
    let own = app
        .world_mut()
        .spawn((Cloth::default(), ClothOrder(7)))
        .id();
    let named = |x: f32| {
        (
            Cloth::default(),
            Name::new("flag"),
            Transform::from_xyz(x, 0.0, 0.0),
        )
    };
    let first = app.world_mut().spawn(named(0.0)).id();
    let second = app.world_mut().spawn(named(-0.0)).id();
    let third = app.world_mut().spawn(named(1.0)).id();
    tick(&mut app, 1);
    let order = |app: &App, of: Entity| *app.world().get::<ClothOrder>(of).expect("an order");
    assert_eq!(order(&app, own), ClothOrder(7));
    assert_eq!(order(&app, first), order(&app, second), "a zero is a zero");
    assert_ne!(order(&app, first), order(&app, third));
    let before = order(&app, third);
    change(&mut app, third, |place: &mut Transform| {
        place.translation.x = 2.0;
    });
    tick(&mut app, 1);
    assert_eq!(order(&app, third), before);
    let copy = app.world_mut().entity_mut(third).clone_and_spawn();
    tick(&mut app, 1);
    assert_ne!(order(&app, copy), before, "a copy stands elsewhere");
}
