//! The flag, its pole, and the wind.

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::windy;
use examples_shared::workshop::{Weave, Workshop};

/// Length of the flag, and height of its upper edge (m).
const LENGTH: f32 = 1.8;
const TOP: f32 = 2.75;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(4.0, 5.0, 3.5),
        DrapePlugins::default(),
        TransformInterpolationPlugin::default(),
        windy::KeysPlugin,
    ))
    // A fresh breeze, from the left and a little towards the camera.
    .insert_resource(ClothWind {
        gusts: 0.25,
        turbulence: 0.4,
        turbulence_length: 0.9,
        ..ClothWind::new(Vec3::new(6.5, 0.0, 0.8))
    })
    .add_systems(Startup, spawn_flag)
    .add_systems(FixedUpdate, sway.before(ClothSystems::Prepare));
}

/// What sways.
#[derive(Component)]
struct Pole;

fn spawn_flag(mut shop: Workshop) {
    let wood = shop.rough(Color::srgb(0.90, 0.90, 0.88), 0.4);
    let brass = shop.brass(0.3);
    let height = TOP + 0.08;
    let stick = (
        shop.mesh(Cylinder::new(0.025, height)),
        wood,
        Transform::from_xyz(-0.025, 0.5 * height, 0.0),
    );
    let knob = (
        shop.mesh(Sphere::new(0.055).mesh().uv(32, 16)),
        brass,
        Transform::from_xyz(-0.025, height + 0.04, 0.0),
    );
    // Its foot is at its origin, around which it leans.
    let pole = (Pole, Transform::default(), Visibility::default());
    let pole = shop
        .commands
        .spawn((Name::new("pole"), pole, TransformInterpolation))
        .insert(children![stick, knob])
        .id();
    let columns = shop.grid.0.max(3);
    let spacing = LENGTH / (columns - 1) as f32;
    let stripes = shop.fabric(Weave::WeftTwill, 2, |runs_down, yarn| {
        match (runs_down, yarn) {
            (false, 0..28) => Color::srgb(0.07, 0.20, 0.48),
            (false, 32..60) => Color::srgb(0.88, 0.28, 0.14),
            _ => Color::srgb(0.95, 0.91, 0.80),
        }
    });
    shop.commands.spawn((
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
        stripes,
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
