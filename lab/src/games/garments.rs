//! Garments: capes, a skirt, a shirt and a bag, on what moves them.

use std::f32::consts::TAU;

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_drape::prelude::*;

use super::cast::{Layers, Path};

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

pub fn cape(world: &mut World, layers: &Layers) {
    world.insert_resource(ClothWind {
        gusts: 0.3,
        turbulence: 0.4,
        turbulence_length: 0.5,
        ..ClothWind::new(Vec3::new(1.5, 0.0, 5.8))
    });
    neck(world, layers, Vec3::ZERO, 24, 32, 0.04, true);
}

pub fn capes(world: &mut World, layers: &Layers) {
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
pub fn skirt(world: &mut World, layers: &Layers, around: u32, down: u32) {
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

/// A shirt: a body that hangs from the shoulders, wider than the figure, and two sleeves on arms that swing.
pub fn shirt(world: &mut World, layers: &Layers) {
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
pub fn bag(world: &mut World, layers: &Layers) {
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
