//! The cloth, the ball that rapier moves, light, and a floor to cast shadows on.

use std::f32::consts::FRAC_PI_4;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{
    Collider, NoUserData, PhysicsSet, RapierPhysicsPlugin, RigidBody, TimestepMode, Velocity,
};

use crate::shared::stage::{Shot, StagePlugin};

/// Particles along either side, as in the paper.
const PARTICLES: u32 = 16;
/// Distance between them (m): the cloth is 3 m wide.
const SPACING: f32 = 0.2;
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
        // Rapier steps with the cloth, once a fixed tick.
        let dt = app
            .world()
            .resource::<Time<Fixed>>()
            .timestep()
            .as_secs_f32();
        app.insert_resource(TimestepMode::Fixed { dt, substeps: 1 })
            .add_plugins((
                RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
                DrapePlugins::default(),
                StagePlugin {
                    has_floor: true,
                    light_from: Vec3::new(4.0, 8.0, 3.0),
                },
            ))
            .add_systems(Startup, (spawn_ball, spawn_cloth))
            .add_systems(FixedFirst, remember_ball)
            .add_systems(FixedUpdate, drive_ball.before(PhysicsSet::SyncBackend))
            .add_systems(Update, smooth_ball);
    }
}

/// The whole cloth, a little from the side.
pub const SHOT: Shot = Shot {
    from: Vec3::new(5.2, 2.9, 2.75),
    focus: Vec3::new(0.0, 1.95, 0.2),
    fov: FRAC_PI_4,
};

/// When the ball last is this far past the cloth's plane, within `seconds` of simulation: the cloth is well
/// wrapped around it.
pub fn best_moment(seconds: f64) -> f64 {
    let past = f64::from((TURNING + 0.45) / SPEED);
    let period = f64::from(4.0 * TURNING / SPEED);
    if seconds < past {
        seconds
    } else {
        past + ((seconds - past) / period).floor() * period
    }
}

/// The cloth of the scene.
pub fn cloth() -> impl Bundle {
    (
        Name::new("cloth"),
        Cloth::new(PARTICLES, PARTICLES, SPACING),
        Pins::top_row(),
        ClothMaterial::COTTON,
        // So small a cloth would be scanned: here the tree is to be seen.
        SearchMethod::Tree(BoundingVolume::Sphere, BoundRule::RestShape),
        // Keeps the flat triangles between the particles out of the ball.
        ClothSettings {
            particle_radius: 0.02,
            ..default()
        },
        Transform::from_xyz(-0.5 * SPACING * (PARTICLES - 1) as f32, TOP, 0.0),
    )
}

fn spawn_cloth(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    let material = materials.add(StandardMaterial {
        base_color: Color::srgb(0.33, 0.43, 0.72),
        perceptual_roughness: 0.9,
        double_sided: true,
        cull_mode: None,
        ..default()
    });
    commands.spawn((cloth(), MeshMaterial3d(material), ShowClothGizmos::level(4)));
}

/// The ball's body, with where it was a tick ago.
#[derive(Component)]
pub struct Ball {
    previous: Vec3,
}

/// What is seen of the ball: drawn between two ticks, as the cloth is.
#[derive(Component)]
struct BallMesh;

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
            Ball { previous: start },
            RigidBody::KinematicVelocityBased,
            Velocity::linear(Vec3::Z * SPEED),
            Collider::ball(RADIUS),
            RapierClothCollider,
            ClothColliderSpeed(SPEED),
            Transform::from_translation(start),
            Visibility::default(),
        ))
        .with_child((BallMesh, Mesh3d(mesh), MeshMaterial3d(material)));
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

fn remember_ball(mut balls: Query<(&Transform, &mut Ball)>) {
    for (transform, mut ball) in &mut balls {
        ball.previous = transform.translation;
    }
}

fn smooth_ball(
    balls: Query<(&Transform, &Ball), Without<BallMesh>>,
    mut drawn: Query<(&mut Transform, &ChildOf), With<BallMesh>>,
    time: Res<Time<Fixed>>,
) {
    for (mut transform, child_of) in &mut drawn {
        if let Ok((body, ball)) = balls.get(child_of.parent()) {
            let back = ball.previous - body.translation;
            transform.translation = back * (1.0 - time.overstep_fraction());
        }
    }
}
