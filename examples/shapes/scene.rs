//! The cloth and the shapes.

use std::f32::consts::TAU;

use bevy::{light::NotShadowCaster, prelude::*};
use bevy_drape::prelude::*;

use crate::shared::{
    stage::{Grid, Shot, StagePlugin},
    woven::woven,
};

/// Particles along either side.
pub const PARTICLES: u32 = 64;
/// Width of the cloth (m).
const WIDTH: f32 = 2.4;
/// The height that it falls from (m).
const HEIGHT: f32 = 0.8;
/// Radius of a marble: less than 2.5 spacings (m).
const MARBLE: f32 = 0.08;

/// The whole of it, from a little above.
pub const SHOT: Shot = Shot {
    from: Vec3::new(0.9, 2.3, 3.5),
    focus: Vec3::new(0.0, 0.1, 0.0),
    fov: 0.5,
};

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        let stage = StagePlugin {
            has_floor: true,
            // So low that each fold has a side in the shade.
            light_from: Vec3::new(-3.5, 3.2, 2.2),
        };
        app.add_plugins((stage, DrapePlugins::default()))
            .add_systems(Startup, (spawn_shapes, spawn_cloth));
    }
}

fn spawn_shapes(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((Name::new("floor"), ClothCollider::plane()));
    let mut spawn = |name: &str, collider, mesh: Mesh, place: Transform, color: Color| {
        let material = materials.add(StandardMaterial {
            base_color: color,
            perceptual_roughness: 0.5,
            ..default()
        });
        let mesh = (Mesh3d(meshes.add(mesh)), MeshMaterial3d(material));
        commands.spawn((Name::new(name.to_string()), collider, mesh, place));
    };
    spawn(
        "ball",
        ClothCollider::ball(0.3),
        Sphere::new(0.3).mesh().uv(64, 32),
        Transform::from_xyz(-0.6, 0.3, -0.5),
        Color::srgb(0.92, 0.42, 0.04),
    );
    spawn(
        "capsule",
        ClothCollider::capsule(0.13, 0.3),
        Capsule3d::new(0.13, 0.3).into(),
        Transform::from_xyz(0.6, 0.28, -0.55),
        Color::srgb(0.05, 0.48, 0.28),
    );
    spawn(
        "box",
        ClothCollider::cuboid(0.44, 0.2, 0.36),
        Cuboid::new(0.44, 0.2, 0.36).into(),
        Transform::from_xyz(0.6, 0.1, 0.4).with_rotation(Quat::from_rotation_y(0.5)),
        Color::srgb(0.72, 0.08, 0.14),
    );
    for marble in 0..4 {
        let angle = TAU * marble as f32 / 4.0;
        let place = Vec3::new(0.34 * angle.cos(), MARBLE, 0.34 * angle.sin());
        spawn(
            &format!("marble {}", marble + 1),
            ClothCollider::ball(MARBLE),
            Sphere::new(MARBLE).mesh().uv(32, 16),
            Transform::from_translation(Vec3::new(-0.5, 0.0, 0.5) + place),
            Color::srgb(0.08, 0.28, 0.72),
        );
    }
}

fn spawn_cloth(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    grid: Res<Grid>,
) {
    // A tea towel: off-white, with a thin stripe every so often along both ways.
    let weave = woven(&mut images, 5, |_, yarn| {
        if (29..33).contains(&yarn) {
            Color::srgb(0.50, 0.16, 0.22)
        } else {
            Color::srgb(0.93, 0.91, 0.86)
        }
    });
    let material = materials.add(StandardMaterial {
        // So sheer that what is below is seen.
        base_color: Color::WHITE.with_alpha(0.42),
        alpha_mode: AlphaMode::Blend,
        ..weave
    });
    commands.spawn((
        Name::new("cloth"),
        Cloth::new(grid.0, grid.0, WIDTH / (grid.0 - 1) as f32)
            .lying()
            .centred(),
        Pins::none(),
        ClothMaterial {
            friction: 0.4,
            damping: 0.02,
            ..ClothMaterial::SILK
        },
        ClothSettings {
            // Keeps the flat triangles between the particles off the box's corners.
            particle_radius: 0.015,
            // So that it stays inside of its envelope as it lands.
            ..ClothSettings::substeps(36)
        },
        MeshMaterial3d(material),
        // Sheer fabric lets the light through.
        NotShadowCaster,
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.0, HEIGHT, 0.0),
    ));
}
