//! The posts, the sail and its ties, and the swing.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{Collider, ColliderMassProperties, RigidBody, Velocity};
use bevy_transform_interpolation::prelude::TransformInterpolation;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::{
    physics::PhysicsPlugin,
    workshop::{Paint, Weave, Workshop},
};

/// Half of the distances between the posts, their height, and their radius (m).
const POSTS: Vec3 = Vec3::new(1.25, 2.7, 0.95);
const POST: f32 = 0.035;
/// Half of the sail's length and width (m), and how much longer its ties are than the way to it.
const SAIL: Vec2 = Vec2::new(0.85, 0.6);
const SLACK: f32 = 1.1;
/// The swing: the height of its bar and of its plank, and half of the plank's size (m), its mass (kg), and where its slings are (m).
const BAR: f32 = 2.0;
const SEAT: f32 = 0.55;
const PLANK: Vec3 = Vec3::new(0.38, 0.018, 0.13);
pub const MASS: f32 = 3.0;
const SLINGS: f32 = 0.28;
/// Radius of the ropes (m), distance between their particles, and mass of a metre (kg).
const ROPE: f32 = 0.009;
const SPACING: f32 = 0.025;
const PER_METRE: f32 = 0.25;
/// Speed of a push (m/s).
const PUSH: f32 = 1.6;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        PhysicsPlugin,
        DrapePlugins::default(),
        StagePlugin::lit_from(-3.0, 5.0, 3.0),
    ))
    .add_plugins(Keys(&[("T", "push the swing")]))
    .insert_resource(ClothWind::gusty(Vec3::new(1.5, 0.3, 0.8)))
    .add_systems(Startup, (spawn_posts, spawn_sail, spawn_swing))
    .add_systems(
        Update,
        push.run_if(|keys: Option<Res<ButtonInput<KeyCode>>>| {
            keys.is_some_and(|keys| keys.just_pressed(KeyCode::KeyT))
        }),
    );
}

/// The plank's body.
#[derive(Component)]
pub struct Plank;

/// Pushes the swing.
pub fn push(mut planks: Query<&mut Velocity, With<Plank>>) {
    for mut velocity in &mut planks {
        velocity.linear.z += PUSH;
    }
}

fn spawn_posts(mut shop: Workshop) {
    let wood = shop.rough(Color::srgb(0.40, 0.26, 0.15), 0.75);
    let post = shop.mesh(Cylinder::new(POST, POSTS.y + 0.1));
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let place = Vec3::new(x * POSTS.x, 0.5 * POSTS.y + 0.05, z * POSTS.z);
        let post = (
            post.clone(),
            wood.clone(),
            Transform::from_translation(place),
        );
        shop.commands.spawn(post);
    }
    let lying = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    let upright = shop.mesh(Cylinder::new(POST, BAR + 0.06));
    for x in [-0.7, 0.7] {
        let place = Transform::from_xyz(x, 0.5 * BAR, 0.0);
        shop.commands.spawn((upright.clone(), wood.clone(), place));
    }
    let bar = shop.mesh(Cylinder::new(0.03, 1.5));
    let place = Transform::from_xyz(0.0, BAR + 0.03, 0.0).with_rotation(lying);
    shop.commands.spawn((bar, wood, place));
}

/// Hemp: a rope weighs as much as a band of its material that is as wide as it is thick.
fn hemp() -> ClothMaterial {
    ClothMaterial {
        areal_density: PER_METRE / (2.0 * ROPE),
        // Far stiffer than cloth.
        stretch_compliance: 1.0e-6,
        damping: 0.3,
        ..ClothMaterial::CANVAS
    }
}

fn rope_paint(shop: &mut Workshop) -> Paint {
    shop.rough(Color::srgb(0.76, 0.64, 0.42), 0.9)
}

/// The sail, and a tie from each of its corners to a post.
fn spawn_sail(mut shop: Workshop) {
    let columns = shop.grid.0.max(6);
    let spacing = 2.0 * SAIL.x / (columns - 1) as f32;
    let rows = (2.0 * SAIL.y / spacing).round() as u32 + 1;
    let fabric = shop.fabric(Weave::Twill, 4, |runs_down, yarn| {
        match (runs_down, yarn / 16 % 2) {
            (true, 0) => Color::srgb(0.16, 0.36, 0.55),
            _ => Color::srgb(0.93, 0.91, 0.84),
        }
    });
    let sail = (
        Name::new("sail"),
        Cloth::new(columns, rows, spacing).lying().centred(),
        Pins::none(),
        ClothMaterial::CANVAS,
        fabric,
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.0, POSTS.y, 0.0),
    );
    let sail = shop.commands.spawn(sail).id();
    let paint = rope_paint(&mut shop);
    let size = Vec2::new((columns - 1) as f32, (rows - 1) as f32) * spacing / 2.0;
    for (corner, x, z) in [
        (Corner::TopLeft, -1.0, -1.0),
        (Corner::TopRight, 1.0, -1.0),
        (Corner::BottomLeft, -1.0, 1.0),
        (Corner::BottomRight, 1.0, 1.0),
    ] {
        let post = Vec3::new(x * POSTS.x, POSTS.y, z * POSTS.z);
        let way = Vec3::new(x * size.x, POSTS.y, z * size.y) - post;
        let length = SLACK * way.length();
        let particles = (length / SPACING).ceil() as u32 + 1;
        let place = Transform::from_translation(post)
            .with_rotation(Quat::from_rotation_arc(Vec3::NEG_Y, way.normalize()));
        let tie = (
            Name::new("tie"),
            Cloth::rope(particles, length / (particles - 1) as f32, ROPE),
            hemp(),
            paint.clone(),
            ShowClothGizmos::nothing(),
            place,
        );
        let tie = shop.commands.spawn(tie).id();
        let end = Pin::Index(particles as usize - 1);
        shop.commands
            .spawn(ClothSeam::new((tie, end), (sail, Pin::Corner(corner))).closing_in(1.0));
    }
}

/// The plank, in two slings whose ends hang from the bar.
fn spawn_swing(mut shop: Workshop) {
    let paint = rope_paint(&mut shop);
    // Down, across below the plank, and up.
    let at = |y: f32, z: f32| Vec3::new(0.0, y - BAR, z);
    let side = PLANK.z + ROPE;
    let path = [
        at(BAR, -side),
        at(SEAT, -side),
        at(SEAT, side),
        at(BAR, side),
    ];
    let rope = Cloth::rope_along(path, SPACING, ROPE);
    let ends = Pin::at_rest(|place| place.y > -1.0e-3);
    for x in [-SLINGS, SLINGS] {
        shop.commands.spawn((
            Name::new("sling"),
            rope.clone(),
            Pins::new([ends.clone()]),
            hemp(),
            // They carry many times their own weight.
            ClothSettings::substeps(90),
            paint.clone(),
            ShowClothGizmos::nothing(),
            Transform::from_xyz(x, BAR, 0.0),
        ));
    }
    let plank = shop.mesh(Cuboid::from_size(2.0 * PLANK));
    let wood = shop.rough(Color::srgb(0.62, 0.42, 0.24), 0.6);
    shop.commands
        .spawn((
            Name::new("plank"),
            Plank,
            TransformInterpolation,
            RigidBody::Dynamic,
            Velocity::default(),
            Collider::cuboid(PLANK.x, PLANK.y, PLANK.z),
            ColliderMassProperties::Mass(MASS),
            RapierClothCollider,
            ClothPushBack,
            Transform::from_xyz(0.0, SEAT + ROPE + PLANK.y + 0.002, 0.0),
            Visibility::default(),
        ))
        .with_child((plank, wood));
}
