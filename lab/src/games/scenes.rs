//! The scenes: cloth of games whose layers touch.

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::{
    cast::{Layers, Moved, Path},
    garments::{bag, cape, capes, shirt, skirt},
};

/// A scene: its name, its length in ticks, whether its cloths begin apart, and its spawning function.
#[derive(Clone, Copy)]
pub struct Scene {
    pub name: &'static str,
    pub ticks: usize,
    pub begins_apart: bool,
    spawn: fn(&mut World, &Layers),
}

/// All scenes.
pub const SCENES: [Scene; 24] = [
    scene("cape behind a runner", 240, cape),
    scene("flag, 8 to 15 m/s", 240, flag),
    scene("skirt, 3,072 vertices", 240, |world, layers| {
        skirt(world, layers, 96, 32);
    }),
    scene("skirt, 1,152 vertices", 240, |world, layers| {
        skirt(world, layers, 48, 24);
    }),
    scene("30 capes apart", 180, capes),
    scene("dropped on edge, 32²", 360, |world, layers| {
        dropped(world, layers, 32);
    }),
    scene("dropped on edge, 48²", 360, |world, layers| {
        dropped(world, layers, 48);
    }),
    scene("tablecloth on a box", 240, |world, layers| {
        tablecloth(world, layers, ClothCollider::cuboid(1.0, 0.1, 1.0));
    }),
    scene("tablecloth on a cylinder", 240, |world, layers| {
        tablecloth(world, layers, ClothCollider::cylinder(0.5, 0.1));
    }),
    scene("32² on 40²", 240, |world, layers| {
        let falls = Cloth::new(32, 32, 0.025).lying().centred();
        on_another(world, layers, 40, falls);
    }),
    scene("16² on 64²", 240, |world, layers| {
        let falls = Cloth::new(16, 16, 0.05).lying().centred();
        on_another(world, layers, 64, falls);
    }),
    scene("mesh on grid, 32² on 40²", 240, |world, layers| {
        let square = Plane3d::default().mesh().size(0.775, 0.775);
        let square = Mesh::from(square.subdivisions(30));
        let square = world.resource_mut::<Assets<Mesh>>().add(square);
        on_another(world, layers, 40, (Cloth::mesh(), Mesh3d(square)));
    }),
    scene("towel lowered on a sheet", 300, lowered),
    inside(scene("panels, edges meet", 180, |world, layers| {
        panels(world, layers, 0.0);
    })),
    inside(scene("panels, overlap of 10 cm", 180, |world, layers| {
        panels(world, layers, 0.1);
    })),
    inside(scene("two in one place", 120, in_one_place)),
    scene("half on half, 64²", 120, |world, layers| {
        folded(world, layers, 64);
    }),
    scene("half on half, 32²", 120, |world, layers| {
        folded(world, layers, 32);
    }),
    scene("flat, 64²", 120, flat),
    scene("50 far apart", 120, fifty),
    scene("twisted strip", 180, twisted),
    scene("shirt", 240, shirt),
    scene("bag", 240, bag),
    scene("laundry", 240, laundry),
];

const fn scene(name: &'static str, ticks: usize, spawn: fn(&mut World, &Layers)) -> Scene {
    Scene {
        name,
        ticks,
        begins_apart: true,
        spawn,
    }
}

const fn inside(scene: Scene) -> Scene {
    Scene {
        begins_apart: false,
        ..scene
    }
}

impl Scene {
    pub fn spawn(&self, world: &mut World, layers: &Layers) {
        (self.spawn)(world, layers);
    }
}

fn flag(world: &mut World, layers: &Layers) {
    world.insert_resource(ClothWind {
        gusts: 0.3,
        turbulence: 0.5,
        turbulence_length: 0.6,
        ..ClothWind::new(Vec3::new(11.5, 0.0, 1.0))
    });
    let place = Transform::from_xyz(0.0, 2.0, 0.0);
    let cloth = Cloth::new(30, 20, 0.04);
    layers.spawn(world, (cloth, Pins::new([Pin::Column(0)]), place));
}

/// A sheet of 1.2 m that stands on its edge, leaning a little.
fn dropped(world: &mut World, layers: &Layers, side: u32) {
    world.spawn(ClothCollider::plane());
    let turn = Quat::from_euler(EulerRot::XYZ, 0.1, 0.03, 0.02);
    let place = Transform::from_xyz(0.0, 0.62, 0.0).with_rotation(turn);
    let cloth = Cloth::new(side, side, 1.2 / (side - 1) as f32).centred();
    layers.spawn(world, (cloth, Pins::none(), place));
}

fn tablecloth(world: &mut World, layers: &Layers, table: ClothCollider) {
    world.spawn(ClothCollider::plane());
    world.spawn((table, Transform::from_xyz(0.0, 0.65, 0.0)));
    let cloth = Cloth::new(64, 64, 1.6 / 63.0).lying().centred();
    layers.spawn(
        world,
        (cloth, Pins::none(), Transform::from_xyz(0.0, 0.75, 0.0)),
    );
}

/// A sheet falls on one of `side`² particles that hangs by its corners.
fn on_another(world: &mut World, layers: &Layers, side: u32, falls: impl Bundle) {
    let last = side - 1;
    let hung = Cloth::new(side, side, 0.975 / last as f32);
    let corners = [0, last].map(|row| [0, last].map(|column| Pin::Cell(row, column)));
    let hung = (hung.lying().centred(), Pins::new(corners.concat()));
    layers.spawn(world, (hung, Transform::default()));
    let turn = Quat::from_euler(EulerRot::XYZ, 0.1, 0.45, 0.05);
    let place = Transform::from_xyz(0.05, 0.2, 0.02).with_rotation(turn);
    layers.spawn(world, (falls, Pins::none(), place));
}

/// A towel is lowered on a sheet on the floor. The sheet sleeps until the towel is near.
fn lowered(world: &mut World, layers: &Layers) {
    world.spawn(ClothCollider::plane());
    let sheet = Cloth::new(32, 32, 0.04).lying().centred();
    let place = Transform::from_xyz(0.0, 0.01, 0.0);
    let sheet = layers.spawn(world, (sheet, Pins::none(), place));
    world.entity_mut(sheet).insert(ClothSettings::default());
    let path = |seconds: f32, _: usize| {
        let height = (1.4 - 0.4 * seconds).max(0.02);
        Transform::from_xyz(0.0, height, 0.0)
    };
    let hand = world.spawn((path(0.0, 0), Path(path, 0))).id();
    let held = ClothAttachments::new([(Pin::Row(0), hand)]);
    let towel = Cloth::new(24, 24, 0.03).centred();
    // It hangs from the hand.
    let place = Transform::from_xyz(0.0, 1.4 - 0.345, 0.0);
    layers.spawn(world, (towel, Pins::none(), held, place));
}

/// Two panels of a curtain whose tops are held.
fn panels(world: &mut World, layers: &Layers, overlap: f32) {
    world.insert_resource(ClothWind {
        gusts: 0.3,
        turbulence: 0.4,
        ..ClothWind::new(Vec3::new(0.3, 0.0, 1.5))
    });
    for sign in [-1.0, 1.0] {
        let cloth = Cloth::new(25, 36, 0.04).centred();
        let place = Transform::from_xyz(sign * (0.48 - overlap / 2.0), 0.0, 0.0);
        layers.spawn(world, (cloth, Pins::top_row(), place));
    }
}

fn in_one_place(world: &mut World, layers: &Layers) {
    for _ in 0..2 {
        layers.spawn(world, (Cloth::new(12, 12, 0.05).centred(), Pins::top_row()));
    }
}

/// A sheet that lies folded in its middle.
fn folded(world: &mut World, layers: &Layers, side: u32) {
    world.spawn(ClothCollider::plane());
    let cloth = Cloth::new(side, side, 1.0 / (side - 1) as f32)
        .lying()
        .centred();
    layers.spawn(
        world,
        (
            cloth,
            Pins::none(),
            Moved(|Vec3 { x, z, .. }| {
                let (radius, low) = (0.004, 0.003);
                let half = TAU / 4.0 * radius;
                if z < -half {
                    Vec3::new(x, low, z + half)
                } else if z > half {
                    Vec3::new(x, low + 2.0 * radius, half - z)
                } else {
                    let angle = z / radius;
                    Vec3::new(x, low + radius * (1.0 + angle.sin()), radius * angle.cos())
                }
            }),
        ),
    );
}

fn flat(world: &mut World, layers: &Layers) {
    let cloth = Cloth::new(64, 64, 1.0 / 63.0).lying().centred();
    layers.spawn(
        world,
        (cloth, Pins::none(), Transform::from_xyz(0.0, 50.0, 0.0)),
    );
}

fn fifty(world: &mut World, layers: &Layers) {
    for index in 0..50 {
        let place = Transform::from_xyz(1.5 * (index % 8) as f32, 0.0, 1.5 * (index / 8) as f32);
        let cloth = Cloth::new(12, 12, 1.0 / 11.0).centred();
        layers.spawn(world, (cloth, Pins::top_row(), place));
    }
}

/// A strip of 1.2 × 0.4 m whose ends turn against each other, four turns in all.
fn twisted(world: &mut World, layers: &Layers) {
    let path = |seconds: f32, index: usize| {
        let sign = if index == 0 { -1.0 } else { 1.0 };
        let angle = (5.0 * seconds).min(2.0 * TAU);
        let nearer = 0.2 * angle / (2.0 * TAU);
        Transform::from_xyz(sign * (0.6 - nearer), 0.0, 0.0)
            .with_rotation(Quat::from_rotation_x(sign * angle))
    };
    let [left, right] = [0, 1].map(|index| world.spawn((path(0.0, index), Path(path, index))).id());
    let cloth = Cloth::new(24, 8, 1.2 / 23.0).centred();
    let held = ClothAttachments::new([(Pin::Column(0), left), (Pin::Column(23), right)]);
    layers.spawn(world, (cloth, Pins::none(), held));
}

/// Six towels fall on each other.
fn laundry(world: &mut World, layers: &Layers) {
    world.spawn(ClothCollider::plane());
    for index in 0..6 {
        let turn = Quat::from_euler(EulerRot::YXZ, 0.7 * index as f32, 0.3, 0.1 * index as f32);
        let place = Transform::from_xyz(0.02 * index as f32, 0.25 + 0.22 * index as f32, 0.0)
            .with_rotation(turn);
        let cloth = Cloth::new(16, 24, 0.03).lying().centred();
        layers.spawn(world, (cloth, Pins::none(), place));
    }
}
