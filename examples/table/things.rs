//! What stands on the table: bodies of rapier's, made of Bevy's primitives.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{Collider, ColliderMassProperties, Friction, RigidBody, Velocity};
use bevy_transform_interpolation::prelude::TransformInterpolation;
use examples_shared::workshop::{Paint, Workshop};

use crate::scene::SURFACE;

/// A body, and where it stands at first.
#[derive(Component)]
pub struct Thing(pub Transform);

/// A part of a thing: its mesh, how high its middle is above the thing's foot (m), and its material.
type Part = (Mesh, f32, Paint);

/// A cylinder that is a part of a body's collider: its radius, and how high its ends are (m).
type Solid = [f32; 3];

pub fn spawn(mut shop: Workshop) {
    let porcelain = shop.rough(Color::srgb(0.90, 0.90, 0.88), 0.25);
    let blue = shop.rough(Color::srgb(0.08, 0.22, 0.48), 0.25);
    let glass = shop.rough(Color::srgb(0.03, 0.20, 0.10), 0.12);
    let paper = shop.rough(Color::srgb(0.88, 0.82, 0.66), 0.8);
    let cork = shop.rough(Color::srgb(0.55, 0.36, 0.20), 0.9);
    let brass = shop.paint(StandardMaterial {
        base_color: Color::srgb(0.86, 0.62, 0.24),
        perceptual_roughness: 0.3,
        metallic: 0.9,
        ..default()
    });
    let wax = shop.rough(Color::srgb(0.93, 0.88, 0.76), 0.6);

    let mut spawn =
        |name: &str, mass: f32, [x, z]: [f32; 2], parts: Vec<Part>, solids: &[Solid]| {
            let home = Transform::from_xyz(x, SURFACE, z);
            let solids = solids.iter().map(|&[radius, low, high]| {
                let cylinder = Collider::cylinder(0.5 * (high - low), radius);
                (Vec3::Y * 0.5 * (low + high), Quat::IDENTITY, cylinder)
            });
            let parts = parts.into_iter().map(|(mesh, height, material)| {
                let place = Transform::from_xyz(0.0, height, 0.0);
                (shop.mesh(mesh), material, place)
            });
            let parts: Vec<_> = parts.collect();
            let mut thing = shop.commands.spawn((
                Name::new(name.to_string()),
                Thing(home),
                home,
                Visibility::default(),
                TransformInterpolation,
                (
                    RigidBody::Dynamic,
                    Velocity::default(),
                    Collider::compound(solids.collect()),
                    ColliderMassProperties::Mass(mass),
                    Friction::coefficient(0.5),
                    // Cloth touches the body's own shape, carries it on the table, and rubs on it.
                    RapierClothCollider,
                    ClothPushBack,
                ),
            ));
            for part in parts {
                thing.with_child(part);
            }
        };

    for (side, number) in [(-1.0, 1), (1.0, 2)] {
        let plate = vec![
            (cylinder(0.085, 0.012), 0.006, porcelain.clone()),
            (
                Torus::new(0.078, 0.132)
                    .mesh()
                    .major_resolution(64)
                    .build()
                    .scaled_by(Vec3::new(1.0, 0.25, 1.0)),
                0.014,
                porcelain.clone(),
            ),
            (
                Torus::new(0.124, 0.134).mesh().major_resolution(64).build(),
                0.016,
                blue.clone(),
            ),
        ];
        let solids = [[0.11, 0.0, 0.02]];
        let name = format!("plate {number}");
        spawn(&name, 0.5, [0.36 * side, 0.06 * side], plate, &solids);
        let cup = vec![
            (cylinder(0.036, 0.075), 0.0375, blue.clone()),
            (cylinder(0.031, 0.001), 0.0756, porcelain.clone()),
        ];
        let name = format!("cup {number}");
        let solids = [[0.036, 0.0, 0.075]];
        spawn(&name, 0.25, [0.2 * side, -0.24 * side], cup, &solids);
    }
    let bottle = vec![
        (cylinder(0.038, 0.19), 0.095, glass.clone()),
        (cylinder(0.0385, 0.08), 0.1, paper),
        (frustum(0.013, 0.038, 0.05), 0.215, glass.clone()),
        (cylinder(0.013, 0.07), 0.275, glass),
        (cylinder(0.0105, 0.02), 0.315, cork),
    ];
    let solids = [[0.038, 0.0, 0.2], [0.013, 0.2, 0.325]];
    spawn("bottle", 1.2, [0.07, -0.05], bottle, &solids);
    let candlestick = vec![
        (frustum(0.022, 0.055, 0.025), 0.0125, brass.clone()),
        (cylinder(0.009, 0.15), 0.1, brass.clone()),
        (frustum(0.03, 0.012, 0.02), 0.18, brass),
        (cylinder(0.011, 0.14), 0.25, wax),
    ];
    let solids = [[0.055, 0.0, 0.02], [0.012, 0.02, 0.32]];
    spawn("candlestick", 0.7, [-0.12, 0.05], candlestick, &solids);
}

fn cylinder(radius: f32, height: f32) -> Mesh {
    Cylinder::new(radius, height).mesh().resolution(64).build()
}

fn frustum(radius_top: f32, radius_bottom: f32, height: f32) -> Mesh {
    let frustum = ConicalFrustum {
        radius_top,
        radius_bottom,
        height,
    };
    frustum.mesh().resolution(64).build()
}
