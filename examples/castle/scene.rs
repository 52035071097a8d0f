//! The castle and its flags.

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::shared::{
    stage::{Grid, Shot, StagePlugin},
    woven::{Weave, woven},
};

/// Particles along a flag; down it there are half as many.
pub const PARTICLES: u32 = 24;
/// Length of a flag, and of its pole (m).
const LENGTH: f32 = 1.5;
const POLE: f32 = 2.2;
/// Half of a side of the walls, their height and thickness (m).
const HALF: f32 = 9.0;
const WALL: f32 = 4.0;
const THICK: f32 = 1.0;
/// Radius and height of a tower at a corner, and of the keep (m).
const TOWER: [f32; 2] = [1.7, 6.5];
const KEEP: [f32; 2] = [2.8, 10.5];
/// Flags on each wall, around each tower, and on the keep: sixty.
const ON_WALL: u32 = 8;
const ON_TOWER: u32 = 4;
const ON_KEEP: u32 = 12;

/// When the picture is drawn (s).
pub const DRAWN_AT: f64 = 3.0;

/// All of it.
pub const SHOT: Shot = Shot {
    from: Vec3::new(15.0, 9.5, 34.0),
    focus: Vec3::new(1.0, 5.6, 0.0),
    fov: 0.52,
};

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        let stage = StagePlugin {
            has_floor: true,
            light_from: Vec3::new(-26.0, 26.0, 24.0),
        };
        app.init_resource::<Grid>()
            .insert_resource(ClothWind {
                turbulence_length: 4.0,
                ..ClothWind::gusty(Vec3::new(7.0, 0.0, 1.5))
            })
            // From 25 m on each flag moves in every second tick, from 50 m on in every fourth.
            .insert_resource(GlobalClothLod(ClothLod::default()))
            .add_plugins((stage, DrapePlugins::default()))
            .add_systems(Startup, (spawn_castle, spawn_flags));
    }
}

/// The four corners, and the wall that begins at each: which way it goes.
fn corners() -> [(Vec3, Vec3); 4] {
    [
        (Vec3::new(-HALF, 0.0, -HALF), Vec3::X),
        (Vec3::new(HALF, 0.0, -HALF), Vec3::Z),
        (Vec3::new(HALF, 0.0, HALF), Vec3::NEG_X),
        (Vec3::new(-HALF, 0.0, HALF), Vec3::NEG_Z),
    ]
}

/// Where the poles stand.
fn places() -> Vec<Vec3> {
    let mut places = Vec::new();
    let mut around = |centre: Vec3, [radius, height]: [f32; 2], count: u32| {
        places.extend((0..count).map(|number| {
            let angle = TAU * (number as f32 + 0.5) / count as f32;
            let out = radius - 0.15;
            centre + Vec3::new(out * angle.cos(), height, out * angle.sin())
        }));
    };
    for (corner, _) in corners() {
        around(corner, TOWER, ON_TOWER);
    }
    around(Vec3::ZERO, KEEP, ON_KEEP);
    for (corner, along) in corners() {
        let from = corner + along * TOWER[0] + Vec3::Y * WALL;
        let length = 2.0 * (HALF - TOWER[0]);
        let place = |number: u32| from + along * length * (number as f32 + 0.5) / ON_WALL as f32;
        places.extend((0..ON_WALL).map(place));
    }
    places
}

fn spawn_flags(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    grid: Res<Grid>,
) {
    let colors = [
        Color::srgb(0.80, 0.10, 0.13),
        Color::srgb(0.93, 0.66, 0.12),
        Color::srgb(0.08, 0.30, 0.58),
    ];
    let fabrics = colors.map(|color| {
        let stripes = woven(Weave::WeftTwill, &mut images, 1, |runs_down, yarn| {
            match (runs_down, yarn) {
                (false, 26..38) => Color::srgb(0.95, 0.92, 0.84),
                _ => color,
            }
        });
        materials.add(stripes)
    });
    let wood = materials.add(Color::srgb(0.30, 0.19, 0.11));
    let stick = meshes.add(Cylinder::new(0.05, POLE));
    let columns = grid.0.max(4);
    let spacing = LENGTH / (columns - 1) as f32;
    for (number, place) in places().into_iter().enumerate() {
        let top = place + Vec3::Y * (POLE - 0.05);
        commands.spawn((
            Mesh3d(stick.clone()),
            MeshMaterial3d(wood.clone()),
            Transform::from_translation(place + Vec3::Y * 0.5 * POLE),
        ));
        commands.spawn((
            Name::new(format!("flag {number}")),
            Cloth::new(columns, columns / 2, spacing),
            Pins::new([Pin::Column(0)]),
            ClothSettings::substeps(12),
            MeshMaterial3d(fabrics[number % fabrics.len()].clone()),
            ShowClothGizmos::nothing(),
            Transform::from_translation(top),
        ));
    }
}

fn spawn_castle(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let stone = |color: Color| StandardMaterial {
        base_color: color,
        perceptual_roughness: 0.95,
        reflectance: 0.1,
        ..default()
    };
    let light = materials.add(stone(Color::srgb(0.62, 0.57, 0.50)));
    let dark = materials.add(stone(Color::srgb(0.50, 0.46, 0.42)));
    let merlon = meshes.add(Cuboid::new(0.55, 0.6, 0.4));
    let mut merlons = Vec::new();
    for (centre, [radius, height]) in corners()
        .map(|(corner, _)| (corner, TOWER))
        .into_iter()
        .chain([(Vec3::ZERO, KEEP)])
    {
        commands.spawn((
            Mesh3d(meshes.add(Cylinder::new(radius, height).mesh().resolution(48))),
            MeshMaterial3d(dark.clone()),
            Transform::from_translation(centre + 0.5 * height * Vec3::Y),
        ));
        let count = (TAU * radius / 1.1) as u32;
        merlons.extend((0..count).map(|number| {
            let turn = Quat::from_rotation_y(TAU * number as f32 / count as f32);
            let out = turn * Vec3::Z * (radius - 0.2);
            Transform::from_translation(centre + out + (height + 0.3) * Vec3::Y).with_rotation(turn)
        }));
    }
    for (corner, along) in corners() {
        let middle = corner + along * HALF + 0.5 * WALL * Vec3::Y;
        let turn = Quat::from_rotation_arc(Vec3::X, along);
        commands.spawn((
            Mesh3d(meshes.add(Cuboid::new(2.0 * HALF, WALL, THICK))),
            MeshMaterial3d(light.clone()),
            Transform::from_translation(middle).with_rotation(turn),
        ));
        let outwards = along.cross(Vec3::Y) * (0.5 * THICK - 0.2);
        let count = (2.0 * (HALF - TOWER[0]) / 1.1) as u32;
        merlons.extend((0..count).map(|number| {
            let way = TOWER[0] + 1.1 * (number as f32 + 0.5);
            let place = corner + along * way + outwards + (WALL + 0.3) * Vec3::Y;
            Transform::from_translation(place).with_rotation(turn)
        }));
    }
    for place in merlons {
        commands.spawn((Mesh3d(merlon.clone()), MeshMaterial3d(light.clone()), place));
    }
    // The gate.
    commands.spawn((
        Mesh3d(meshes.add(Cuboid::new(2.2, 2.6, 0.1))),
        MeshMaterial3d(materials.add(Color::srgb(0.20, 0.12, 0.07))),
        Transform::from_xyz(0.0, 1.3, HALF + 0.5 * THICK),
    ));
}
