//! A world of cloths of every kind.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    characters::{
        arm::{By, ELBOW, Worn, angle, dress, spawn_arm},
        rig::{bind, rig},
    },
    meshes::sheets::{sheet, sheet_asset},
    support::*,
};

/// The game's clock: which tick comes next.
#[derive(Resource, Default, Clone, Copy)]
pub struct Clock(pub u32);

/// How far the world's origin has jumped so far (m).
#[derive(Resource, Default, Clone, Copy)]
pub struct Origin(pub Vec3);

/// What the game moves: by where it is in each tick.
#[derive(Component, Clone, Copy)]
struct Moves(fn(f32) -> Transform);

/// What the game moves on from where it is: by a velocity (m/s).
#[derive(Component, Clone, Copy)]
struct Drifts(Vec3);

const SECONDS: f32 = TICK;

fn animate(
    mut moving: Query<(Entity, &Moves, &mut Transform, Has<ChildOf>)>,
    mut drifting: Query<(&Drifts, &mut Transform), Without<Moves>>,
    origin: Res<Origin>,
    mut clock: ResMut<Clock>,
    mut commands: Commands,
    mut materials: Query<(&Name, &mut ClothMaterial)>,
) {
    let seconds = clock.0 as f32 * SECONDS;
    for (entity, moves, mut place, is_below) in &mut moving {
        let mut to = (moves.0)(seconds);
        if !is_below {
            to.translation += origin.0;
        }
        // A way of metres in a tick is a teleport.
        if to.translation.distance(place.translation) > 1.0 && clock.0 > 0 {
            commands.entity(entity).insert(ClothTeleport);
        }
        place.set_if_neq(to);
    }
    for (drifts, mut place) in &mut drifting {
        place.translation += drifts.0 * SECONDS;
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

/// An app with cloths of every kind: swinging, creasing, asleep on a ball and woken, attached, holding a tolerance, teleported, in layers, on a
/// body, in gusts, below a root that carries it, at a lower rate, on a skeleton, on an arm that bends, before a fan that comes by, full of gas. The same entities each time.
pub fn everything() -> (App, Vec<Entity>) {
    everything_after(0)
}

/// The same in an app that has spawned some other entities before: all ids are greater.
pub fn everything_after(others: usize) -> (App, Vec<Entity>) {
    let mut app = app_that_draws(FixedUpdate);
    let others = std::iter::repeat_n(Transform::default(), others);
    app.world_mut().spawn_batch(others);
    app.init_resource::<Clock>()
        .init_resource::<Origin>()
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
    let creases = ClothCreasing {
        yield_curvature: 1.0,
        hardening: 0.3,
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
    let exact = (triangles, edge(), creases, ClothSettings::tolerance(0.02));
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
    let folding = (
        Cloth::new(12, 12, 0.05),
        creases,
        ClothSelfCollision::default(),
    );
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
    // Before a fan that comes by.
    let flag = (Cloth::new(9, 9, 0.1), Pins::new([Pin::Column(0)]));
    cloths.push(world.spawn((flag, still, at(140.0, 0.0, 0.0))).id());
    let fan = ClothWindZone::fan(3.0, 0.5, 6.0);
    let drifts = Drifts(Vec3::X * 0.4);
    world.spawn((fan, drifts, at(139.0, -0.3, 1.5)));
    // Full of gas, on a box.
    let ball = Sphere::new(0.3).mesh().ico(3).expect("few");
    let ball = (world.resource_mut::<Assets<Mesh>>()).add(ball);
    let gas = ClothPressure::gas(0.12);
    let balloon = (Cloth::mesh(), Mesh3d(ball), Pins::none(), gas);
    cloths.push(world.spawn((balloon, at(150.0, 0.4, 0.0))).id());
    world.spawn((ClothCollider::cuboid(0.5, 0.1, 0.5), at(150.0, -0.1, 0.0)));
    // On a skeleton that moves, half of it held, before backstops.
    let skin = ClothSkin::within(ClothPaint::at_rest(|place| place.z)).with_backstop(0.05, 0.4);
    let rig = rig(&mut app, (skin, still));
    cloths.push(rig.cloth);
    // And one that falls on an arm that bends.
    let arm = spawn_arm(&mut app, By::Mesh, at(180.0, 0.0, 0.0));
    cloths.push(dress(&mut app, &arm, Worn::Sheet, still));
    // And one that sleeps on an arm that bends later.
    let calm = spawn_arm(&mut app, By::Mesh, at(190.0, 0.0, 0.0));
    let pinned = Pins::new([Corner::TopLeft, Corner::BottomRight].map(Pin::Corner));
    cloths.push(dress(&mut app, &calm, Worn::Sheet, (pinned, still, damped)));
    let walks: [fn(f32) -> Transform; 3] = [|t| swing(0, t), |t| swing(1, t), |t| swing(2, t)];
    let mut insert = |entity: Entity, moves: fn(f32) -> Transform| {
        let bundle = (Moves(moves), moves(0.0));
        app.world_mut().entity_mut(entity).insert(bundle);
    };
    for (bone, walks) in rig.bones.into_iter().zip(walks) {
        insert(bone, walks);
    }
    insert(arm.joints[1], |t| {
        let bent = Quat::from_rotation_z(angle(1.5, 1.0, t));
        Transform::from_xyz(ELBOW, 0.0, 0.0).with_rotation(bent)
    });
    insert(calm.joints[1], |t| {
        let bent = Quat::from_rotation_z(0.2 * (t - 8.0).max(0.0));
        Transform::from_xyz(ELBOW, 0.0, 0.0).with_rotation(bent)
    });
    insert(rig.root, |t| {
        Transform::from_xyz(170.0 + 0.3 * t.sin(), 0.0, 0.2 * t)
    });
    (app, cloths)
}

/// Where a bone is above the one below it.
fn swing(bone: usize, seconds: f32) -> Transform {
    let turn = Vec3::new(0.2, 0.1, 0.4) * (5.0 * seconds).sin() * bone as f32;
    bind(bone) * Transform::from_rotation(Quat::from_scaled_axis(turn))
}
