//! The cloth and the shapes.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use bevy_drape::prelude::*;

use crate::shared::stage::{Shot, StagePlugin};

/// Particles along either side.
const PARTICLES: u32 = 96;
/// Width of the cloth (m).
const WIDTH: f32 = 2.4;
/// The height that it falls from (m).
const HEIGHT: f32 = 0.8;
/// Radius of a marble: less than 2.5 spacings (m).
const MARBLE: f32 = 0.062;

/// The whole of it, from a little above.
pub const SHOT: Shot = Shot {
    from: Vec3::new(0.8, 2.9, 3.1),
    focus: Vec3::new(0.0, 0.08, 0.06),
    fov: 0.49,
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
        ClothCollider::ball(0.27),
        Sphere::new(0.27).mesh().uv(64, 32),
        Transform::from_xyz(-0.6, 0.27, -0.55),
        Color::srgb(0.95, 0.6, 0.2),
    );
    spawn(
        "capsule",
        ClothCollider::capsule(0.1, 0.3),
        Capsule3d::new(0.1, 0.3).into(),
        Transform::from_xyz(0.62, 0.25, -0.55),
        Color::srgb(0.3, 0.65, 0.4),
    );
    spawn(
        "box",
        ClothCollider::cuboid(0.44, 0.2, 0.36),
        Cuboid::new(0.44, 0.2, 0.36).into(),
        Transform::from_xyz(0.6, 0.1, 0.4).with_rotation(Quat::from_rotation_y(0.5)),
        Color::srgb(0.75, 0.3, 0.3),
    );
    for marble in 0..4 {
        let angle = TAU * marble as f32 / 4.0;
        let place = Vec3::new(0.34 * angle.cos(), MARBLE, 0.34 * angle.sin());
        spawn(
            &format!("marble {}", marble + 1),
            ClothCollider::ball(MARBLE),
            Sphere::new(MARBLE).mesh().uv(32, 16),
            Transform::from_translation(Vec3::new(-0.5, 0.0, 0.5) + place),
            Color::srgb(0.35, 0.55, 0.85),
        );
    }
}

fn spawn_cloth(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let material = materials.add(StandardMaterial {
        base_color_texture: Some(images.add(checks())),
        perceptual_roughness: 0.95,
        reflectance: 0.2,
        double_sided: true,
        cull_mode: None,
        ..default()
    });
    // Laid out from its transform along x and, turned down, along z.
    let flat = Transform::from_xyz(-WIDTH / 2.0, HEIGHT, -WIDTH / 2.0)
        .with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
    commands.spawn((
        Name::new("cloth"),
        Cloth::new(PARTICLES, PARTICLES, WIDTH / (PARTICLES - 1) as f32),
        Pins::none(),
        ClothMaterial {
            friction: 0.4,
            damping: 0.02,
            ..ClothMaterial::SILK
        },
        ClothSettings {
            // Keeps the flat triangles between the particles off the box's corners.
            particle_radius: 0.015,
            ..default()
        },
        MeshMaterial3d(material),
        ShowClothGizmos {
            levels: None,
            springs: false,
        },
        flat,
    ));
}

/// A checked weave: stripes along both ways, darker where they cross.
fn checks() -> Image {
    const SIZE: u32 = 512;
    const STRIPES: u32 = 12;
    let is_stripe = |at: u32| (at * STRIPES * 2 / SIZE) % 2;
    let mut texels = Vec::new();
    for row in 0..SIZE {
        for column in 0..SIZE {
            texels.extend_from_slice(match is_stripe(row) + is_stripe(column) {
                0 => &[236, 232, 222, 255],
                1 => &[150, 172, 206, 255],
                _ => &[70, 104, 160, 255],
            });
        }
    }
    let size = Extent3d {
        width: SIZE,
        height: SIZE,
        depth_or_array_layers: 1,
    };
    Image::new(
        size,
        TextureDimension::D2,
        texels,
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    )
}
