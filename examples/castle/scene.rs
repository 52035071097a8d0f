//! The castle and its flags.

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use examples_shared::arrows::up_down;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};

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

/// The scene, without a camera.
pub fn build(app: &mut App) {
    let stage = StagePlugin::lit_from(-26.0, 26.0, 24.0);
    app.add_plugins((stage, DrapePlugins::default()))
        .insert_resource(ClothWind {
            turbulence_length: 4.0,
            ..ClothWind::gusty(Vec3::new(7.0, 0.0, 1.5))
        })
        // From 25 m on each flag moves in every second tick, from 50 m on in every fourth.
        .insert_resource(GlobalClothLod(ClothLod::default()))
        .add_plugins(Keys(&[
            ("Up, Down", "stronger, weaker wind"),
            ("D", "level of detail on, off"),
        ]))
        .add_systems(Startup, (spawn_castle, spawn_flags))
        .add_systems(Update, press_keys);
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut wind: ResMut<ClothWind>,
    lod: Option<Res<GlobalClothLod>>,
    mut commands: Commands,
) {
    wind.velocity *= 1.25_f32.powf(up_down(&keys));
    if keys.just_pressed(KeyCode::KeyD) {
        match lod {
            Some(_) => commands.remove_resource::<GlobalClothLod>(),
            None => commands.insert_resource(GlobalClothLod(ClothLod::default())),
        }
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

fn spawn_flags(mut shop: Workshop) {
    let colors = [
        Color::srgb(0.80, 0.10, 0.13),
        Color::srgb(0.93, 0.66, 0.12),
        Color::srgb(0.08, 0.30, 0.58),
    ];
    let fabrics = colors.map(|color| {
        shop.fabric(Weave::WeftTwill, 1, |runs_down, yarn| {
            match (runs_down, yarn) {
                (false, 26..38) => Color::srgb(0.95, 0.92, 0.84),
                _ => color,
            }
        })
    });
    let wood = shop.paint(Color::srgb(0.30, 0.19, 0.11));
    let stick = shop.mesh(Cylinder::new(0.05, POLE));
    let columns = shop.grid.0.max(4);
    let spacing = LENGTH / (columns - 1) as f32;
    for (number, place) in places().into_iter().enumerate() {
        let top = place + Vec3::Y * (POLE - 0.05);
        let middle = Transform::from_translation(place + Vec3::Y * 0.5 * POLE);
        shop.commands.spawn((stick.clone(), wood.clone(), middle));
        shop.commands.spawn((
            Name::new(format!("flag {number}")),
            Cloth::new(columns, columns / 2, spacing),
            Pins::new([Pin::Column(0)]),
            ClothSettings::substeps(12),
            fabrics[number % fabrics.len()].clone(),
            ShowClothGizmos::nothing(),
            Transform::from_translation(top),
        ));
    }
}

fn spawn_castle(mut shop: Workshop) {
    let mut stone = |color: Color| {
        shop.paint(StandardMaterial {
            base_color: color,
            perceptual_roughness: 0.95,
            reflectance: 0.1,
            ..default()
        })
    };
    let light = stone(Color::srgb(0.62, 0.57, 0.50));
    let dark = stone(Color::srgb(0.50, 0.46, 0.42));
    let mut merlons = Vec::new();
    for (centre, [radius, height]) in corners()
        .map(|(corner, _)| (corner, TOWER))
        .into_iter()
        .chain([(Vec3::ZERO, KEEP)])
    {
        let tower = shop.mesh(Cylinder::new(radius, height).mesh().resolution(48));
        let middle = Transform::from_translation(centre + 0.5 * height * Vec3::Y);
        shop.commands.spawn((tower, dark.clone(), middle));
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
        let wall = shop.mesh(Cuboid::new(2.0 * HALF, WALL, THICK));
        let place = Transform::from_translation(middle).with_rotation(turn);
        shop.commands.spawn((wall, light.clone(), place));
        let outwards = along.cross(Vec3::Y) * (0.5 * THICK - 0.2);
        let count = (2.0 * (HALF - TOWER[0]) / 1.1) as u32;
        merlons.extend((0..count).map(|number| {
            let way = TOWER[0] + 1.1 * (number as f32 + 0.5);
            let place = corner + along * way + outwards + (WALL + 0.3) * Vec3::Y;
            Transform::from_translation(place).with_rotation(turn)
        }));
    }
    let merlon = shop.mesh(Cuboid::new(0.55, 0.6, 0.4));
    for place in merlons {
        shop.commands.spawn((merlon.clone(), light.clone(), place));
    }
    let gate = (
        shop.mesh(Cuboid::new(2.2, 2.6, 0.1)),
        shop.paint(Color::srgb(0.20, 0.12, 0.07)),
        Transform::from_xyz(0.0, 1.3, HALF + 0.5 * THICK),
    );
    shop.commands.spawn(gate);
}
