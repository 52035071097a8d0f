//! The cloth, the ball that rapier moves, light, and a floor to cast shadows on.

use bevy::prelude::*;
use bevy_drape::{
    hierarchy::{BoundRule, BoundingVolume},
    plugin::ClothColliderSpeed,
    prelude::*,
};
use bevy_rapier3d::prelude::{Collider, PhysicsSet, RigidBody, Velocity};
use bevy_transform_interpolation::prelude::TransformInterpolation;
use examples_shared::{
    physics::PhysicsPlugin,
    stage::{Grid, Shot, StagePlugin},
    woven::{Weave, woven},
};

/// Width of the cloth (m): 16 particles of the paper, 0.2 m apart.
const WIDTH: f32 = 3.0;
/// The level of the tree that is drawn: 16 × 16 volumes, whatever the grid.
const LEVEL: usize = 4;
/// Height of the top row above the floor (m).
const TOP: f32 = 3.7;
/// The paper's ball (m).
const RADIUS: f32 = 1.0;
/// How far from the cloth the ball turns back (m).
const TURNING: f32 = 2.8;
/// The ball's speed at the start (m/s).
const SPEED: f32 = 1.5;

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Grid>()
            .add_plugins((
                PhysicsPlugin,
                DrapePlugins::default(),
                StagePlugin::lit_from(5.5, 6.5, 1.8),
            ))
            .add_systems(Startup, (spawn_ball, spawn_cloth))
            .add_systems(FixedUpdate, drive_ball.before(PhysicsSet::SyncBackend));
    }
}

/// The whole cloth, a little from the side.
pub const SHOT: Shot = Shot {
    from: Vec3::new(2.5, 3.1, 6.6),
    focus: Vec3::new(0.0, 1.8, 0.2),
    fov: 0.7,
};

/// When the ball last is `past` metres beyond the cloth's plane, within `seconds` of simulation.
pub fn moment_beyond(past: f32, seconds: f64) -> f64 {
    let past = f64::from((TURNING + past) / SPEED);
    let period = f64::from(4.0 * TURNING / SPEED);
    if seconds < past {
        seconds
    } else {
        past + ((seconds - past) / period).floor() * period
    }
}

/// The cloth of the scene.
pub fn cloth(Grid(particles): Grid) -> impl Bundle {
    (
        Name::new("cloth"),
        Cloth::new(particles, particles, WIDTH / (particles - 1) as f32).centred(),
        Pins::top_row(),
        ClothMaterial::COTTON,
        // So small a cloth would be scanned: here the tree is to be seen.
        SearchMethod::Tree(BoundingVolume::Sphere, BoundRule::RestShape),
        // Keeps the flat triangles between the particles out of the ball.
        ClothSettings {
            particle_radius: 0.02,
            ..default()
        },
        Transform::from_xyz(0.0, TOP - 0.5 * WIDTH, 0.0),
    )
}

fn spawn_cloth(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    grid: Res<Grid>,
) {
    // Chambray: one way blue, the other lighter.
    let material = materials.add(woven(Weave::Plain, &mut images, 4, |runs_down, _| {
        if runs_down {
            Color::srgb(0.20, 0.33, 0.64)
        } else {
            Color::srgb(0.42, 0.54, 0.80)
        }
    }));
    let half = Rect::new(0.5, 0.0, 1.0, 1.0);
    commands.spawn((
        cloth(*grid),
        MeshMaterial3d(material),
        ShowClothGizmos::level(LEVEL).within(half),
    ));
}

/// The ball's body.
#[derive(Component)]
pub struct Ball;

fn spawn_ball(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let start = Vec3::new(0.0, 1.75, -TURNING);
    let mesh = meshes.add(Sphere::new(RADIUS).mesh().uv(64, 32));
    let material = materials.add(StandardMaterial {
        base_color: Color::srgb(0.95, 0.6, 0.2),
        perceptual_roughness: 0.5,
        ..default()
    });
    commands
        .spawn((
            Name::new("ball"),
            Ball,
            // Drawn between two ticks, as the cloth is.
            TransformInterpolation,
            RigidBody::KinematicVelocityBased,
            Velocity::linear(Vec3::Z * SPEED),
            Collider::ball(RADIUS),
            RapierClothCollider,
            ClothColliderSpeed(SPEED),
            Transform::from_translation(start),
            Visibility::default(),
        ))
        .with_child((Mesh3d(mesh), MeshMaterial3d(material)));
}

/// Back and forth along z. Rapier does the moving.
pub fn drive_ball(mut balls: Query<(&Transform, &ClothColliderSpeed, &mut Velocity), With<Ball>>) {
    for (transform, speed, mut velocity) in &mut balls {
        let z = transform.translation.z;
        let onwards = if velocity.linear.z < 0.0 { -1.0 } else { 1.0 };
        let direction = if z.abs() < TURNING {
            onwards
        } else {
            -z.signum()
        };
        // A still ball keeps the way that it will go.
        velocity.linear = Vec3::Z * direction * speed.0.max(f32::MIN_POSITIVE);
    }
}
