//! Snapshots: what is put back goes on to the last bit, in the same app and in a new one.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    meshes::sheets::{sheet, sheet_asset},
    support::*,
};

/// The game's clock: which tick comes next.
#[derive(Resource, Default, Clone, Copy)]
struct Clock(u32);

/// What the game moves: by where it is in each tick.
#[derive(Component, Clone, Copy)]
struct Moves(fn(f32) -> Transform);

const SECONDS: f32 = TICK;

fn animate(
    mut moving: Query<(Entity, &Moves, &mut Transform)>,
    mut clock: ResMut<Clock>,
    mut commands: Commands,
    mut materials: Query<(&Name, &mut ClothMaterial)>,
) {
    let seconds = clock.0 as f32 * SECONDS;
    for (entity, moves, mut place) in &mut moving {
        let to = (moves.0)(seconds);
        // A way of metres in a tick is a teleport.
        if to.translation.distance(place.translation) > 1.0 && clock.0 > 0 {
            commands.entity(entity).insert(ClothTeleport);
        }
        place.set_if_neq(to);
    }
    for (name, mut material) in &mut materials {
        if name.as_str() == "animated" {
            material.friction = 0.2 + 0.1 * (clock.0 % 5) as f32;
        }
    }
    clock.0 += 1;
}

/// Where what passes once is, at a speed along z.
fn once(at: Vec3, velocity: Vec3, seconds: f32) -> Transform {
    Transform::from_translation(at + velocity * seconds.clamp(0.5, 3.0))
}

/// An app with cloths of every kind: swinging, asleep on a ball and woken, attached, holding a tolerance, teleported, in layers, on a
/// body, in gusts, below a root that carries it, at a lower rate. The same entities each time.
fn everything() -> (App, Vec<Entity>) {
    let mut app = app_that_draws(FixedUpdate);
    app.init_resource::<Clock>()
        .add_systems(FixedUpdate, animate.before(ClothSystems::Prepare))
        .insert_resource(ClothWind {
            gusts: 0.5,
            turbulence: 0.3,
            ..ClothWind::new(Vec3::new(0.4, 0.0, 0.8))
        });
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(sheet_asset(9, 8));
    let (positions, triangles) = sheet(8, 8);
    let at = Transform::from_xyz;
    let still = ClothAir {
        velocity: Some(Vec3::ZERO),
        drag: 0.0,
        lift: 0.0,
    };
    let edge = || Pins::new([Pin::at_rest(|place| place.z < 0.01)]);
    let world = app.world_mut();
    let mut cloths = Vec::new();
    let ball = |radius| ClothCollider::ball(radius);
    // Passed by a ball.
    let passed = (Cloth::default(), Name::new("animated"));
    cloths.push(world.spawn((passed, at(0.0, 0.0, 0.0))).id());
    let passing = Moves(|t| once(Vec3::new(0.75, -1.0, -3.0), Vec3::Z * 2.2, t));
    world.spawn((ball(0.4), at(0.0, 0.0, 0.0), passing));
    // Falls asleep on a ball, which goes away later.
    let corners = Pins::new([
        Pin::Corner(Corner::TopLeft),
        Pin::Corner(Corner::BottomRight),
    ]);
    let damped = ClothMaterial {
        damping: 0.05,
        ..default()
    };
    let sleeper = (Cloth::new(9, 9, 0.1).lying().centred(), corners, damped);
    cloths.push(world.spawn((sleeper, still, at(10.0, 0.0, 0.0))).id());
    let woken = Moves(|t| Transform::from_xyz(10.0 + 0.3 * (t - 8.0).max(0.0), -0.35, 0.0));
    world.spawn((ball(0.3), at(10.0, -0.35, 0.0), woken));
    // Attached, to a pole that is found by its name and to an entity.
    let swings = Moves(|t| Transform::from_xyz(20.0 + 0.2 * (2.0 * t).sin(), 0.3 * t.sin(), 0.0));
    let pole = (at(20.0, 0.0, 0.0), swings, Name::new("pole"));
    let pole = world.spawn(pole).id();
    let pin = Pin::at_rest(|place| place.x < 0.01);
    let by_name = ClothAttachments::new([(pin, "pole")]);
    let attached = (Cloth::mesh(), Mesh3d(mesh), by_name, at(20.0, 0.0, 0.0));
    cloths.push(world.spawn(attached).id());
    let by_entity = ClothAttachments::new([(Pin::Column(0), pole)]);
    let attached = (Cloth::new(7, 7, 0.1), Pins::none(), by_entity);
    cloths.push(world.spawn((attached, at(21.0, 0.0, 0.0))).id());
    // Holds a tolerance, on a ball; changes its sub-steps as the ball moves.
    let triangles = Cloth::triangles(positions, triangles);
    let exact = (triangles, edge(), ClothSettings::tolerance(0.02));
    cloths.push(world.spawn((exact, at(30.0, 0.0, 0.0))).id());
    let stirs = Moves(|t| Transform::from_xyz(30.3, -0.4 + 0.1 * (3.0 * t).sin(), 0.3));
    world.spawn((ball(0.15), at(30.3, -0.4, 0.3), stirs));
    // Teleported each second and a half.
    let jumps = Moves(|t| Transform::from_xyz(40.0 + 5.0 * (t / 1.5).floor(), 0.1 * t.sin(), 0.0));
    let jumping = (Cloth::new(7, 9, 0.1), jumps, at(40.0, 0.0, 0.0));
    cloths.push(world.spawn(jumping).id());
    // Layers that fall on each other and on a box.
    for height in [0.3, 0.36, 0.45] {
        let layer = (
            Cloth::new(10, 10, 0.06).lying().centred(),
            Pins::none(),
            ClothSelfCollision::default(),
        );
        cloths.push(world.spawn((layer, still, at(80.0, height, 0.0))).id());
    }
    world.spawn((ClothCollider::cuboid(0.2, 0.1, 0.2), at(80.0, 0.1, 0.0)));
    // Folds onto itself.
    let folding = (Cloth::new(12, 12, 0.05), ClothSelfCollision::default());
    cloths.push(world.spawn((folding, at(90.0, 0.0, 0.0))).id());
    // Carries a body that the game presses into it.
    let border = |row: u32, column: u32| row.is_multiple_of(9) || column.is_multiple_of(9);
    let trampoline = (
        Cloth::new(10, 10, 0.1).lying().centred(),
        Pins::filter(border),
    );
    cloths.push(world.spawn((trampoline, still, at(100.0, 0.0, 0.0))).id());
    let presses = Moves(|t| Transform::from_xyz(100.0, 0.15 - 0.02 * (4.0 * t).sin(), 0.0));
    let body = (ball(0.15), ClothBody::new(0.5, Vec3::splat(0.004)), presses);
    world.spawn((body, at(100.0, 0.15, 0.0)));
    // Falls freely in the gusts.
    let free = (Cloth::new(9, 9, 0.1).lying(), Pins::none());
    cloths.push(world.spawn((free, at(110.0, 0.0, 0.0))).id());
    // Below a root that carries it by a part.
    let runs = Moves(|t| Transform::from_xyz(120.0 + 2.0 * t.sin(), 0.2 * t.cos(), 0.0));
    let root = (at(120.0, 0.0, 0.0), runs, ClothInertia::share(0.3));
    let root = world.spawn(root).id();
    let cape = (Cloth::new(8, 8, 0.1), ChildOf(root), at(0.0, 1.0, 0.0));
    cloths.push(world.spawn(cape).id());
    // At a lower rate.
    let lod = (Cloth::new(8, 8, 0.1), ClothLod::at(ClothLodLevel::Every(3)));
    cloths.push(world.spawn((lod, at(130.0, 0.0, 0.0))).id());
    (app, cloths)
}

/// All that is seen of a tick: particles and contacts of each cloth, bit by bit, and which touches began and ended.
#[derive(PartialEq, Clone)]
struct Seen {
    cloths: Vec<(Vec<u32>, Vec<ClothContact>, bool)>,
    began: Vec<(Entity, Entity)>,
    ended: Vec<(Entity, Entity)>,
}

fn next(app: &mut App, cloths: &[Entity]) -> Seen {
    tick(app, 1);
    let of = |cloth: &Entity| {
        assert!(app.world().get::<ClothFault>(*cloth).is_none());
        let particles = particles(app, *cloth);
        let positions = particles.positions().flat_map(|at| at.to_array());
        let velocities = (0..particles.len())
            .flat_map(|index| particles.velocity(index).expect("it exists").to_array());
        let contacts = app.world().get::<ClothContacts>(*cloth).expect("contacts");
        (
            positions.chain(velocities).map(f32::to_bits).collect(),
            contacts.iter().copied().collect(),
            stats(app, *cloth).is_asleep,
        )
    };
    let cloths = cloths.iter().map(of).collect();
    let began = messages::<ClothTouchStarted>(app);
    let ended = messages::<ClothTouchStopped>(app);
    Seen {
        cloths,
        began: began.iter().map(|of| (of.cloth, of.collider)).collect(),
        ended: ended.iter().map(|of| (of.cloth, of.collider)).collect(),
    }
}

fn compare(expected: &[Seen], app: &mut App, cloths: &[Entity], context: &str) {
    for (number, expected) in expected.iter().enumerate() {
        let found = next(app, cloths);
        for (index, (expected, found)) in expected.cloths.iter().zip(&found.cloths).enumerate() {
            let differ = expected.0.iter().zip(&found.0);
            let differ = differ.filter(|(a, b)| a != b).count();
            assert_eq!(differ, 0, "{context}: cloth {index}, {number} ticks on");
            assert_eq!(expected.1, found.1, "{context}: contacts of {index}");
            assert_eq!(expected.2, found.2, "{context}: sleep of {index}");
        }
        assert!(*expected == found, "{context}: touches {number} ticks on");
    }
}

/// Those of earlier ticks.
fn forget_messages(app: &mut App) {
    messages::<ClothTouchStarted>(app);
    messages::<ClothTouchStopped>(app);
}

/// Saved at some ticks and continued, for up to 600: in the same app, put back there afterwards, and in one that has just begun, from a
/// file.
#[test]
fn what_is_restored_goes_on_to_the_last_bit() {
    for (start, ticks) in [(1, 600), (40, 100), (96, 100), (330, 200)] {
        let (mut app, cloths) = everything();
        tick(&mut app, start);
        let saved = ClothWorldSnapshot::of(app.world_mut());
        let clock = *app.world().resource::<Clock>();
        forget_messages(&mut app);
        let seen: Vec<Seen> = (0..ticks).map(|_| next(&mut app, &cloths)).collect();
        if start == 1 {
            // It is worth the name.
            let slept = seen
                .iter()
                .any(|seen| seen.cloths[1].2 && !seen.cloths[1].1.is_empty());
            let woke = !seen[ticks - 1].cloths[1].2;
            assert!(slept && woke, "asleep on a ball {slept}, woken {woke}");
            assert!(seen.iter().any(|seen| !seen.ended.is_empty()));
        }
        saved.restore(app.world_mut()).expect("the same world");
        app.insert_resource(clock);
        forget_messages(&mut app);
        compare(&seen, &mut app, &cloths, &format!("again from {start}"));
        let text = ron::to_string(&saved).expect("it can be written");
        let read: ClothWorldSnapshot = ron::from_str(&text).expect("it can be read");
        let (mut fresh, same) = everything();
        assert_eq!(cloths, same);
        read.restore(fresh.world_mut()).expect("the same entities");
        fresh.insert_resource(clock);
        compare(&seen, &mut fresh, &cloths, &format!("anew from {start}"));
    }
}

/// Each tick is done eleven times: rolled back by ten, and done again. What comes of it is what comes without.
#[test]
fn ten_ticks_may_be_rolled_back_in_each_tick() {
    let (mut straight, cloths) = everything();
    let (mut rolled, _) = everything();
    tick(&mut straight, 20);
    tick(&mut rolled, 20);
    let mut kept: Vec<(ClothWorldSnapshot, Clock)> = Vec::new();
    for number in 0..60 {
        let mut snapshot = match kept.len() {
            10 => kept.remove(0).0,
            _ => ClothWorldSnapshot::default(),
        };
        snapshot.take(rolled.world_mut());
        kept.push((snapshot, *rolled.world().resource::<Clock>()));
        tick(&mut rolled, 1);
        // Something that came late from elsewhere has all of them done again.
        let (oldest, clock) = kept.first().expect("a tick").clone();
        oldest.restore(rolled.world_mut()).expect("the same world");
        rolled.insert_resource(clock);
        tick(&mut rolled, kept.len());
        tick(&mut straight, 1);
        for (index, cloth) in cloths.iter().enumerate() {
            let (expected, found) = (particles(&straight, *cloth), particles(&rolled, *cloth));
            assert!(expected == found, "cloth {index} in tick {number}");
        }
    }
}

/// One cloth alone, put back without a word on anything else, has its shape, its velocities and its sleep.
#[test]
fn one_cloth_may_be_put_back() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::new(9, 9, 0.1)).id();
    tick(&mut app, 30);
    let saved = ClothSnapshot::of(app.world(), cloth).expect("a cloth");
    assert_eq!(saved.particles(), particles(&app, cloth));
    tick(&mut app, 30);
    let after = particles(&app, cloth).clone();
    saved.restore(app.world_mut(), cloth).expect("the cloth");
    tick(&mut app, 30);
    assert_eq!(&after, particles(&app, cloth));
    // Of other entities in another world.
    let mut other = crate::support::app();
    other.world_mut().spawn_empty();
    let twin = other.world_mut().spawn(Cloth::new(9, 9, 0.1)).id();
    saved.restore(other.world_mut(), twin).expect("a cloth");
    tick(&mut other, 30);
    assert_eq!(&after, particles(&other, twin));
}

/// What can't be restored is said, and nothing is changed.
#[test]
fn what_is_wrong_with_a_snapshot_is_said() {
    let (mut app, cloths) = everything();
    tick(&mut app, 20);
    let saved = ClothWorldSnapshot::of(app.world_mut());
    let text = ron::to_string(&saved).expect("it can be written");
    tick(&mut app, 5);
    let before: Vec<_> = (cloths.iter().map(|cloth| particles(&app, *cloth).clone())).collect();
    let nobody = app.world_mut().spawn_empty().id();
    let error = ClothSnapshot::of(app.world(), nobody).expect_err("no cloth");
    assert_eq!(error, SnapshotError::NoCloth { entity: nobody });
    let (_, one) = saved.cloths().next().expect("a cloth");
    let error = one.restore(app.world_mut(), nobody).expect_err("no cloth");
    assert_eq!(error, SnapshotError::NoCloth { entity: nobody });
    let newer = text.replacen("version:1", "version:2", 1);
    let newer: ClothWorldSnapshot = ron::from_str(&newer).expect("it can be read");
    let error = newer.restore(app.world_mut()).expect_err("a newer one");
    assert_eq!(
        error,
        SnapshotError::Version {
            found: 2,
            expected: 1
        }
    );
    let collider = (app
        .world_mut()
        .query_filtered::<Entity, With<ClothCollider>>())
    .iter(app.world())
    .next()
    .expect("a collider");
    app.world_mut().despawn(collider);
    let error = saved.restore(app.world_mut()).expect_err("one has gone");
    let component = "ClothCollider";
    assert_eq!(
        error,
        SnapshotError::Gone {
            entity: collider,
            component
        }
    );
    for (cloth, before) in cloths.iter().zip(before) {
        assert!(*particles(&app, *cloth) == before);
    }
}
