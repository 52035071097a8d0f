//! The hammock, its posts, and the ball that rapier moves.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{
    Ccd, Collider, ColliderMassProperties, PhysicsSet, RigidBody, Velocity,
};
use bevy_transform_interpolation::prelude::TransformInterpolation;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};
use examples_shared::{arrows::up_down, physics::PhysicsPlugin};

/// Length of the cloth, and in which part of its size its posts stand once it hangs.
const LENGTH: f32 = 2.4;
const SLACK: f32 = 0.86;
/// How long the posts take to come together (s).
const HANGING: f32 = 0.8;
/// Height of the posts (m).
const HEIGHT: f32 = 1.3;
/// The ball (m, kg).
const RADIUS: f32 = 0.2;
pub const MASS: f32 = 1.0;
/// How far it is above the cloth at first (m).
const DROP: f32 = 0.1;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        PhysicsPlugin,
        DrapePlugins::default(),
        StagePlugin::lit_from(-3.0, 5.0, 3.0),
    ))
    .add_plugins(Keys(&[
        ("T", "toss the ball up"),
        ("Up, Down", "double, halve the ball's mass"),
    ]))
    .add_systems(Startup, (spawn_hammock, spawn_ball, spawn_ground))
    .add_systems(FixedUpdate, hang_up.before(PhysicsSet::SyncBackend))
    .add_systems(Update, press_keys);
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut balls: Query<(&mut Velocity, &mut ColliderMassProperties), With<Ball>>,
) {
    for (mut velocity, mut properties) in &mut balls {
        if keys.just_pressed(KeyCode::KeyT) {
            // Some 0.8 m high.
            velocity.linear.y = 4.0;
        }
        let factor = 2.0_f32.powf(up_down(&keys));
        if factor != 1.0
            && let ColliderMassProperties::Mass(mass) = *properties
        {
            // From a beach ball to a cannon ball.
            *properties = ColliderMassProperties::Mass((mass * factor).clamp(0.05, 50.0));
        }
    }
}

/// A post that a corner of the hammock hangs from, and where it is while the cloth is flat.
#[derive(Component)]
struct Post(Vec3);

fn spawn_hammock(mut shop: Workshop) {
    let columns = shop.grid.0.max(4);
    let rows = columns / 2;
    let spacing = LENGTH / (columns - 1) as f32;
    let width = spacing * (rows - 1) as f32;
    let wood = shop.rough(Color::srgb(0.45, 0.28, 0.15), 0.7);
    let pole = shop.mesh(Cylinder::new(0.03, HEIGHT + 0.04));
    let corners = [
        (Corner::TopLeft, -1.0, -1.0),
        (Corner::TopRight, 1.0, -1.0),
        (Corner::BottomLeft, -1.0, 1.0),
        (Corner::BottomRight, 1.0, 1.0),
    ];
    let posts = corners.map(|(corner, x, z)| {
        let place = Vec3::new(0.5 * x * LENGTH, HEIGHT, 0.5 * z * width);
        let post = (
            Post(place),
            TransformInterpolation,
            Transform::from_translation(place),
            Visibility::default(),
        );
        let below = Transform::from_xyz(0.0, -0.5 * HEIGHT, 0.0);
        let pole = (pole.clone(), wood.clone(), below);
        let post = shop.commands.spawn(post).with_child(pole).id();
        (Pin::Corner(corner), post)
    });
    // Stripes across, as hammocks have.
    let stripes = shop.fabric(Weave::Twill, 3, |runs_down, yarn| {
        match (runs_down, yarn / 8 % 4) {
            (true, 0) => Color::srgb(0.80, 0.22, 0.16),
            (true, 2) => Color::srgb(0.10, 0.40, 0.45),
            _ => Color::srgb(0.94, 0.90, 0.80),
        }
    });
    shop.commands.spawn((
        Name::new("hammock"),
        Cloth::new(columns, rows, spacing).lying().centred(),
        Pins::none(),
        ClothAttachments::new(posts),
        ClothMaterial::CANVAS,
        // What is held by four points and carries something needs more of them than by default.
        ClothSettings::substeps(40),
        stripes,
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.0, HEIGHT, 0.0),
    ));
}

/// Brings the posts together, for the cloth between them to sag.
fn hang_up(mut posts: Query<(&Post, &mut Transform)>, time: Res<Time>) {
    let part = (time.elapsed_secs() / HANGING).min(1.0);
    // They start and stop gently.
    let part = part * part * (3.0 - 2.0 * part);
    for (post, mut transform) in &mut posts {
        let narrower = 1.0 - (1.0 - SLACK) * part;
        let place = post.0 * Vec3::new(narrower, 1.0, narrower);
        if transform.translation != place {
            transform.translation = place;
        }
    }
}

/// The ball's body.
#[derive(Component)]
pub struct Ball;

fn spawn_ball(mut shop: Workshop) {
    let mesh = shop.mesh(Sphere::new(RADIUS).mesh().uv(64, 32));
    let orange = shop.rough(Color::srgb(0.95, 0.65, 0.15), 0.45);
    shop.commands
        .spawn((
            Name::new("ball"),
            Ball,
            TransformInterpolation,
            RigidBody::Dynamic,
            Velocity::default(),
            Ccd::enabled(),
            Collider::ball(RADIUS),
            ColliderMassProperties::Mass(MASS),
            RapierClothCollider,
            // The cloth pushes it back.
            ClothPushBack,
            Transform::from_xyz(0.15, HEIGHT + RADIUS + DROP, 0.05),
            Visibility::default(),
        ))
        .with_child((mesh, orange));
}

/// For a ball that is tossed out of the hammock.
fn spawn_ground(mut commands: Commands) {
    commands.spawn((
        RigidBody::Fixed,
        Collider::cuboid(50.0, 0.5, 50.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
}
