//! The scenes: cloth of games whose layers touch.

use std::f32::consts::TAU;

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_drape::prelude::*;

/// Ticks a second.
pub const RATE: f32 = 60.0;

/// A scene: its name, its length in ticks, whether its cloths begin apart, and its spawning function.
#[derive(Clone, Copy)]
pub struct Scene {
    pub name: &'static str,
    pub ticks: usize,
    pub begins_apart: bool,
    spawn: fn(&mut World, &Layers),
}

/// The settings of all cloths of a scene: with contact of cloth with cloth, or without.
pub struct Layers(pub Option<ClothSelfCollision>);

/// How a thing moves: its place at each time (s).
#[derive(Component)]
struct Path(fn(f32, usize) -> Transform, usize);

/// All scenes.
pub const SCENES: [Scene; 21] = [
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
    scene("32² on 40²", 240, on_another),
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

/// Moves what has a path to its place after so many ticks.
pub fn follow(world: &mut World, ticks: u32) {
    let seconds = ticks as f32 / RATE;
    let mut all = world.query::<(&Path, &mut Transform)>();
    for (Path(at, index), mut place) in all.iter_mut(world) {
        *place = at(seconds, *index);
    }
}

impl Layers {
    /// Spawns a cloth that stays awake.
    fn spawn(&self, world: &mut World, cloth: impl Bundle) -> Entity {
        let settings = ClothSettings {
            sleeps: false,
            ..default()
        };
        let mut spawned = world.spawn((settings, cloth));
        if let Some(layers) = self.0 {
            spawned.insert(layers);
        }
        spawned.id()
    }
}

/// A cape's neck row of `columns`, each held by the runner.
fn neck(
    world: &mut World,
    layers: &Layers,
    at: Vec3,
    columns: u32,
    rows: u32,
    spacing: f32,
    runs: bool,
) {
    let path = |seconds: f32, index: usize| {
        let side = 6.0 * (index % 6) as f32;
        let row = (index / 6) as f32 * 3.0;
        let bob = 0.04 * (11.0 * seconds).sin().abs();
        let turn = 0.35 * (1.7 * seconds).sin();
        Transform::from_xyz(side / 3.0, 1.45 + bob, row - 5.0 * seconds)
            .with_rotation(Quat::from_rotation_y(turn))
    };
    let index = ((at.z / 3.0) as usize) * 6 + (at.x / 2.0) as usize;
    let place = if runs {
        path(0.0, index)
    } else {
        Transform::from_translation(at + Vec3::Y * 1.45)
    };
    let mut runner = world.spawn((place, Visibility::default()));
    if runs {
        runner.insert(Path(path, index));
    }
    let runner = runner.id();
    let body = Transform::from_xyz(0.0, -0.45, 0.0);
    world.spawn((ClothCollider::capsule(0.16, 0.8), body, ChildOf(runner)));
    let back = Transform::from_xyz(0.0, 0.05, 0.2);
    let held = ClothAttachments::new([(Pin::Row(0), runner)]);
    let cloth = Cloth::new(columns, rows, spacing);
    layers.spawn(world, (cloth, Pins::none(), held, place * back));
}

fn cape(world: &mut World, layers: &Layers) {
    world.insert_resource(ClothWind {
        gusts: 0.3,
        turbulence: 0.4,
        turbulence_length: 0.5,
        ..ClothWind::new(Vec3::new(1.5, 0.0, 5.8))
    });
    neck(world, layers, Vec3::ZERO, 24, 32, 0.04, true);
}

fn capes(world: &mut World, layers: &Layers) {
    world.insert_resource(ClothWind {
        gusts: 0.3,
        turbulence: 0.4,
        ..ClothWind::new(Vec3::new(0.5, 0.0, 3.0))
    });
    for index in 0..30 {
        let at = Vec3::new(2.0 * (index % 6) as f32, 0.0, 3.0 * (index / 6) as f32);
        neck(world, layers, at, 12, 16, 0.06, false);
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

/// A mesh of rings: `at` gives the place of a vertex around (0 to 1) and down (0 to 1).
fn rings(around: u32, down: u32, at: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let place = |ring: u32, column: u32| {
        at(
            column as f32 / around as f32,
            ring as f32 / (down - 1) as f32,
        )
    };
    let places: Vec<Vec3> = (0..down)
        .flat_map(|ring| (0..around).map(move |column| (ring, column)))
        .map(|(ring, column)| place(ring, column))
        .collect();
    let index = |ring: u32, column: u32| ring * around + column % around;
    let indices = (0..down - 1)
        .flat_map(|ring| (0..around).map(move |column| (ring, column)))
        .flat_map(|(ring, column)| {
            let [a, b] = [index(ring, column), index(ring, column + 1)];
            let [c, d] = [index(ring + 1, column), index(ring + 1, column + 1)];
            // The diagonals alternate.
            if (ring + column) % 2 == 0 {
                [a, c, b, b, c, d]
            } else {
                [a, c, d, a, d, b]
            }
        })
        .collect();
    let normals: Vec<[f32; 3]> = places.iter().map(|_| [0.0, 1.0, 0.0]).collect();
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_indices(Indices::U32(indices))
}

fn mesh(world: &mut World, layers: &Layers, mesh: Mesh, rest: impl Bundle) -> Entity {
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    layers.spawn(world, (Cloth::mesh(), Mesh3d(mesh), Pins::none(), rest))
}

/// A skirt on hips and two legs that walk.
fn skirt(world: &mut World, layers: &Layers, around: u32, down: u32) {
    let hips = world
        .spawn((
            Transform::from_xyz(0.0, 1.0, 0.0),
            ClothCollider::ball(0.15),
        ))
        .id();
    for side in [0, 1] {
        let leg = |seconds: f32, side: usize| {
            let sign = if side == 0 { 1.0 } else { -1.0 };
            let angle = 0.5 * sign * (5.0 * seconds).sin();
            let hip = Vec3::new(0.09 * sign, 0.95, 0.0);
            let turn = Quat::from_rotation_x(angle);
            Transform::from_translation(hip + turn * Vec3::new(0.0, -0.4, 0.0)).with_rotation(turn)
        };
        world.spawn((
            leg(0.0, side),
            Path(leg, side),
            ClothCollider::capsule(0.08, 0.6),
        ));
    }
    let cloth = rings(around, down, |part, down| {
        let angle = part * TAU;
        let flare = 0.165 + 0.19 * down;
        let pleat = 0.02 * down * (12.0 * angle).cos();
        let radius = flare + pleat;
        Vec3::new(radius * angle.cos(), -0.55 * down, radius * angle.sin())
    });
    let waist = Pin::at_rest(|place| place.y > -1.0e-3);
    let held = ClothAttachments::new([(waist, hips)]);
    mesh(
        world,
        layers,
        cloth,
        (held, Transform::from_xyz(0.0, 1.0, 0.0)),
    );
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

/// A sheet falls on one that hangs by its corners.
fn on_another(world: &mut World, layers: &Layers) {
    let hung = Cloth::new(40, 40, 0.025).lying().centred();
    layers.spawn(
        world,
        (
            hung,
            Pins::new([
                Pin::Cell(0, 0),
                Pin::Cell(0, 39),
                Pin::Cell(39, 0),
                Pin::Cell(39, 39),
            ]),
            Transform::default(),
        ),
    );
    let turn = Quat::from_euler(EulerRot::XYZ, 0.1, 0.45, 0.05);
    let place = Transform::from_xyz(0.05, 0.2, 0.02).with_rotation(turn);
    let falls = Cloth::new(32, 32, 0.025).lying().centred();
    layers.spawn(world, (falls, Pins::none(), place));
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

/// Where each particle begins, from its place in the world as the cloth is spawned.
#[derive(Component)]
pub struct Moved(pub fn(Vec3) -> Vec3);

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

/// A shirt: a body that hangs from the shoulders, wider than the figure, and two sleeves on arms that swing.
fn shirt(world: &mut World, layers: &Layers) {
    let chest = world
        .spawn((
            Transform::from_xyz(0.0, 1.2, 0.0),
            ClothCollider::capsule(0.14, 0.4),
        ))
        .id();
    let tube = |radius: f32, pleats: f32| {
        move |part: f32, down: f32| {
            let angle = part * TAU;
            let radius = radius * (1.0 + 0.12 * down * (pleats * angle).cos());
            Vec3::new(radius * angle.cos(), -down, radius * angle.sin())
        }
    };
    let top = || Pin::at_rest(|place| place.y > -1.0e-3);
    let body = rings(48, 24, |part, down| {
        let at = tube(0.2, 8.0)(part, down);
        Vec3::new(at.x, 0.6 * at.y, at.z)
    });
    let held = ClothAttachments::new([(top(), chest)]);
    mesh(
        world,
        layers,
        body,
        (held, Transform::from_xyz(0.0, 1.42, 0.0)),
    );
    for side in [0, 1] {
        let arm = |seconds: f32, side: usize| {
            let sign = if side == 0 { 1.0 } else { -1.0 };
            let swing = Quat::from_rotation_x(0.6 * sign * (5.0 * seconds).sin());
            let shoulder = Vec3::new(0.34 * sign, 1.4, 0.0);
            Transform::from_translation(shoulder + swing * Vec3::new(0.0, -0.25, 0.0))
                .with_rotation(swing)
        };
        let capsule = (
            ClothCollider::capsule(0.05, 0.4),
            arm(0.0, side),
            Path(arm, side),
        );
        let arm_entity = world.spawn(capsule).id();
        let sleeve = rings(24, 16, |part, down| {
            let at = tube(0.085, 5.0)(part, down);
            Vec3::new(at.x, 0.4 * at.y, at.z)
        });
        let held = ClothAttachments::new([(top(), arm_entity)]);
        let sign = if side == 0 { 1.0 } else { -1.0 };
        mesh(
            world,
            layers,
            sleeve,
            (held, Transform::from_xyz(0.34 * sign, 1.4, 0.0)),
        );
    }
}

/// An empty bag that is held by two places of its rim, and swings.
fn bag(world: &mut World, layers: &Layers) {
    let path = |seconds: f32, _: usize| {
        let swing = 0.3 * (4.0 * seconds).sin();
        Transform::from_xyz(swing, 1.0, 0.0).with_rotation(Quat::from_rotation_y(swing))
    };
    let hand = world.spawn((path(0.0, 0), Path(path, 0))).id();
    let cloth = rings(32, 26, |part, down| {
        let angle = part * TAU;
        // Its bottom is a ring.
        let (radius, depth) = if down < 0.8 {
            (0.16, down / 0.8)
        } else {
            (0.16 * (1.2 - down) / 0.4, 1.0)
        };
        Vec3::new(radius * angle.cos(), -0.35 * depth, radius * angle.sin())
    });
    let handles = Pin::at_rest(|place| place.y > -1.0e-3 && place.z.abs() < 0.05);
    let held = ClothAttachments::new([(handles, hand)]);
    mesh(
        world,
        layers,
        cloth,
        (held, Transform::from_xyz(0.0, 1.0, 0.0)),
    );
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
