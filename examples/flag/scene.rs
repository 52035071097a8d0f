//! The flag, its pole, and the wind.

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;

use crate::shared::{
    stage::{Grid, Shot, StagePlugin},
    woven::{Weave, woven},
};

/// Particles along the flag; down it there are two thirds as many.
pub const PARTICLES: u32 = 48;
/// Length of the flag, and height of its upper edge (m).
const LENGTH: f32 = 1.8;
const TOP: f32 = 2.75;

/// When the picture is drawn (s).
pub const DRAWN_AT: f64 = 6.0;

/// The flag, from below.
pub const SHOT: Shot = Shot {
    from: Vec3::new(2.0, 1.3, 4.4),
    focus: Vec3::new(0.8, 2.08, 0.0),
    fov: 0.46,
};

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        let stage = StagePlugin {
            has_floor: true,
            light_from: Vec3::new(4.0, 5.0, 3.5),
        };
        app.init_resource::<Grid>()
            .insert_resource(wind())
            .add_plugins((
                stage,
                DrapePlugins::default(),
                TransformInterpolationPlugin::default(),
            ))
            .add_systems(Startup, spawn_flag)
            .add_systems(FixedUpdate, sway.before(ClothSystems::Prepare));
    }
}

/// A fresh breeze, from the left and a little towards the camera.
pub fn wind() -> ClothWind {
    ClothWind {
        gusts: 0.25,
        turbulence: 0.4,
        turbulence_length: 0.9,
        ..ClothWind::new(Vec3::new(6.5, 0.0, 0.8))
    }
}

/// What sways.
#[derive(Component)]
struct Pole;

fn spawn_flag(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    grid: Res<Grid>,
) {
    let wood = materials.add(StandardMaterial {
        base_color: Color::srgb(0.90, 0.90, 0.88),
        perceptual_roughness: 0.4,
        ..default()
    });
    let brass = materials.add(StandardMaterial {
        base_color: Color::srgb(0.86, 0.62, 0.24),
        perceptual_roughness: 0.3,
        metallic: 0.8,
        ..default()
    });
    let height = TOP + 0.08;
    let stick = (
        Mesh3d(meshes.add(Cylinder::new(0.025, height))),
        MeshMaterial3d(wood),
        Transform::from_xyz(-0.025, 0.5 * height, 0.0),
    );
    let knob = (
        Mesh3d(meshes.add(Sphere::new(0.055).mesh().uv(32, 16))),
        MeshMaterial3d(brass),
        Transform::from_xyz(-0.025, height + 0.04, 0.0),
    );
    // Its foot is at its origin, around which it leans.
    let pole = (Pole, Transform::default(), Visibility::default());
    let pole = commands
        .spawn((Name::new("pole"), pole, TransformInterpolation))
        .insert(children![stick, knob])
        .id();
    let columns = grid.0.max(3);
    let spacing = LENGTH / (columns - 1) as f32;
    let stripes = woven(Weave::WeftTwill, &mut images, 2, |runs_down, yarn| {
        match (runs_down, yarn) {
            (false, 0..28) => Color::srgb(0.07, 0.20, 0.48),
            (false, 32..60) => Color::srgb(0.88, 0.28, 0.14),
            _ => Color::srgb(0.95, 0.91, 0.80),
        }
    });
    commands.spawn((
        Name::new("flag"),
        Cloth::new(columns, columns * 2 / 3, spacing),
        Pins::none(),
        ClothAttachments::new([(Pin::Column(0), pole)]),
        ClothMaterial {
            areal_density: 0.12,
            ..ClothMaterial::COTTON
        },
        ClothSettings::substeps(20),
        ClothSelfCollision::default(),
        MeshMaterial3d(materials.add(stripes)),
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.0, TOP, 0.0),
    ));
}

/// To and fro, as a ship's mast.
fn sway(mut poles: Query<&mut Transform, With<Pole>>, time: Res<Time>) {
    let seconds = time.elapsed_secs();
    for mut pole in &mut poles {
        let lean = 0.06 * (TAU * seconds / 3.5).sin();
        let nod = 0.03 * (TAU * seconds / 2.3).sin();
        pole.rotation = Quat::from_rotation_z(lean) * Quat::from_rotation_x(nod);
    }
}
