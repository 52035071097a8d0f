//! The hammock, its bars, and the ball that rapier moves.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{
    Ccd, Collider, ColliderMassProperties, NoUserData, PhysicsSet, RapierPhysicsPlugin, RigidBody,
    TimestepMode, Velocity,
};
use bevy_transform_interpolation::prelude::{TransformInterpolation, TransformInterpolationPlugin};

use crate::shared::{
    stage::{Grid, Shot, StagePlugin},
    woven::woven,
};

/// Particles along the hammock; across it half as many.
pub const PARTICLES: u32 = 48;
/// Length of the cloth, and of how much less the bars are apart once it hangs (m).
const LENGTH: f32 = 2.4;
const SLACK: f32 = 0.24;
/// How long the bars take to come together (s).
const HANGING: f32 = 0.5;
/// Height of the bars (m).
const HEIGHT: f32 = 1.3;
/// The ball (m, kg).
const RADIUS: f32 = 0.2;
pub const MASS: f32 = 1.5;

/// The whole of it, from the side and a little above.
pub const SHOT: Shot = Shot {
    from: Vec3::new(1.5, 1.9, 4.2),
    focus: Vec3::new(0.0, 0.85, 0.0),
    fov: 0.52,
};

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
        app.init_resource::<Grid>()
            .insert_resource(TimestepMode::Fixed { dt, substeps: 1 })
            .add_plugins((
                RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
                TransformInterpolationPlugin::default(),
                DrapePlugins::default(),
                StagePlugin {
                    has_floor: true,
                    light_from: Vec3::new(-3.0, 5.0, 3.0),
                },
            ))
            .add_systems(Startup, (spawn_hammock, spawn_ball, spawn_ground))
            .add_systems(FixedUpdate, hang_up.before(PhysicsSet::SyncBackend));
    }
}

/// A bar that the hammock hangs from, and on which side it is.
#[derive(Component)]
struct Bar(f32);

fn spawn_hammock(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    grid: Res<Grid>,
) {
    let columns = grid.0.max(4);
    let rows = columns / 2;
    let spacing = LENGTH / (columns - 1) as f32;
    let width = spacing * (rows - 1) as f32;
    let wood = materials.add(StandardMaterial {
        base_color: Color::srgb(0.45, 0.28, 0.15),
        perceptual_roughness: 0.7,
        ..default()
    });
    let rod = meshes.add(Cylinder::new(0.025, width + 0.1));
    let post = meshes.add(Cylinder::new(0.03, HEIGHT));
    let bars = [-1.0, 1.0].map(|side| {
        let place = Transform::from_xyz(0.5 * side * LENGTH, HEIGHT, 0.0);
        let bar = (
            Bar(side),
            TransformInterpolation,
            place,
            Visibility::default(),
        );
        let across = Transform::from_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
        let bar = commands.spawn(bar).id();
        let rod = (Mesh3d(rod.clone()), MeshMaterial3d(wood.clone()), across);
        commands.entity(bar).with_child(rod);
        for end in [-0.5, 0.5] {
            let place = Transform::from_xyz(0.0, -0.5 * HEIGHT, end * (width + 0.1));
            let post = (Mesh3d(post.clone()), MeshMaterial3d(wood.clone()), place);
            commands.entity(bar).with_child(post);
        }
        bar
    });
    // Stripes across, as hammocks have.
    let weave = woven(&mut images, 3, |runs_down, yarn| {
        match (runs_down, yarn / 8 % 4) {
            (true, 0) => Color::srgb(0.80, 0.22, 0.16),
            (true, 2) => Color::srgb(0.10, 0.40, 0.45),
            _ => Color::srgb(0.94, 0.90, 0.80),
        }
    });
    let last = columns - 1;
    let [left, right] = bars;
    commands.spawn((
        Name::new("hammock"),
        Cloth::new(columns, rows, spacing).lying().centred(),
        Pins::none(),
        ClothAttachments::new([
            (Pin::filter(|_, column| column == 0), left),
            (Pin::filter(move |_, column| column == last), right),
        ]),
        ClothMaterial {
            friction: 0.5,
            damping: 0.02,
            ..ClothMaterial::COTTON
        },
        MeshMaterial3d(materials.add(weave)),
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.0, HEIGHT, 0.0),
    ));
}

/// Brings the bars together, for the cloth between them to sag.
fn hang_up(mut bars: Query<(&Bar, &mut Transform)>, time: Res<Time>) {
    let part = (time.elapsed_secs() / HANGING).min(1.0);
    // They start and stop gently.
    let part = part * part * (3.0 - 2.0 * part);
    for (bar, mut transform) in &mut bars {
        let x = 0.5 * bar.0 * (LENGTH - SLACK * part);
        if transform.translation.x != x {
            transform.translation.x = x;
        }
    }
}

/// The ball's body.
#[derive(Component)]
pub struct Ball;

fn spawn_ball(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mesh = meshes.add(Sphere::new(RADIUS).mesh().uv(64, 32));
    let material = materials.add(StandardMaterial {
        base_color: Color::srgb(0.95, 0.65, 0.15),
        perceptual_roughness: 0.45,
        ..default()
    });
    commands
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
            Transform::from_xyz(0.15, HEIGHT + 0.7, 0.05),
            Visibility::default(),
        ))
        .with_child((Mesh3d(mesh), MeshMaterial3d(material)));
}

/// For a ball that is tossed out of the hammock.
fn spawn_ground(mut commands: Commands) {
    commands.spawn((
        RigidBody::Fixed,
        Collider::cuboid(50.0, 0.5, 50.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
}
