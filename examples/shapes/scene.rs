//! The cloths and the shapes.

use std::f32::consts::TAU;

use bevy::{light::NotShadowCaster, mesh::VertexAttributeValues, prelude::*};
use bevy_drape::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::workshop::{Weave, Workshop};

/// Width of the cloth (m).
const WIDTH: f32 = 2.4;
/// The height that it falls from (m).
const HEIGHT: f32 = 0.8;
/// Radius of a marble: less than 2.5 spacings (m).
const MARBLE: f32 = 0.08;

/// Where the second cloth and its shapes are (m).
const SECOND: Vec3 = Vec3::new(2.5, 0.0, 0.0);
/// How far the dunes reach (m), and how many heights they have along either side.
const DUNES: f32 = 0.9;
const HEIGHTS: usize = 19;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    // So low that each fold has a side in the shade.
    let stage = StagePlugin::lit_from(-3.5, 3.2, 2.2);
    app.add_plugins((stage, DrapePlugins::default()))
        .add_systems(Startup, (spawn_shapes, spawn_others, spawn_cloths));
}

fn spawn_shape(
    shop: &mut Workshop,
    name: &str,
    collider: ClothCollider,
    mesh: Mesh,
    place: Transform,
    color: Color,
) {
    let look = (shop.mesh(mesh), shop.rough(color, 0.5));
    let name = Name::new(name.to_string());
    shop.commands.spawn((name, collider, look, place));
}

fn spawn_shapes(mut shop: Workshop) {
    shop.commands
        .spawn((Name::new("floor"), ClothCollider::plane()));
    let mut spawn = |name: &str, collider, mesh: Mesh, place, color| {
        spawn_shape(&mut shop, name, collider, mesh, place, color);
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

/// Those that are more than a formula, below the second cloth: solids of Bevy's, a stone by the hull of its mesh, a ring by the
/// triangles of its own, and dunes.
fn spawn_others(mut shop: Workshop) {
    let mut spawn = |name: &str, collider, mesh: Mesh, place: Transform, color| {
        let place = place.with_translation(SECOND + place.translation);
        spawn_shape(&mut shop, name, collider, mesh, place, color);
    };
    let cylinder = Cylinder::new(0.2, 0.4);
    spawn(
        "cylinder",
        cylinder.into(),
        cylinder.mesh().resolution(64).into(),
        Transform::from_xyz(-0.55, 0.2, -0.55),
        Color::srgb(0.92, 0.42, 0.04),
    );
    let cone = Cone::new(0.25, 0.5);
    spawn(
        "cone",
        cone.into(),
        cone.mesh().resolution(64).into(),
        Transform::from_xyz(0.6, 0.25, -0.6),
        Color::srgb(0.05, 0.48, 0.28),
    );
    spawn(
        "stone",
        ClothCollider::mesh_hull(),
        stone(),
        Transform::from_xyz(0.0, 0.14, 0.05),
        Color::srgb(0.35, 0.36, 0.40),
    );
    spawn(
        "ring",
        ClothCollider::mesh(),
        Torus::new(0.12, 0.32).into(),
        Transform::from_xyz(-0.6, 0.1, 0.55),
        Color::srgb(0.72, 0.08, 0.14),
    );
    let heights: Vec<f32> = (0..HEIGHTS * HEIGHTS)
        .map(|index| {
            let along = |cell: usize| DUNES * (cell as f32 / (HEIGHTS - 1) as f32 - 0.5);
            dune(along(index % HEIGHTS), along(index / HEIGHTS))
        })
        .collect();
    spawn(
        "dunes",
        ClothCollider::heightfield(heights, HEIGHTS, Vec3::new(DUNES, 1.0, DUNES)),
        dunes(),
        Transform::from_xyz(0.6, 0.0, 0.55),
        Color::srgb(0.80, 0.62, 0.34),
    );
}

/// A ball of twenty sides, flattened and bent out of shape.
fn stone() -> Mesh {
    let mut mesh = Sphere::new(0.18)
        .mesh()
        .ico(0)
        .expect("twenty sides are few");
    change_positions(&mut mesh, |place| {
        let bent = 1.0 + 0.25 * (17.0 * place.x + 29.0 * place.z).sin();
        place * Vec3::new(bent, 0.75, 1.2)
    });
    mesh.duplicate_vertices();
    mesh.compute_flat_normals();
    mesh
}

/// How high the dunes are (m).
fn dune(x: f32, z: f32) -> f32 {
    let rim = ((1.0 - (2.0 * x / DUNES).powi(4)) * (1.0 - (2.0 * z / DUNES).powi(4))).max(0.0);
    rim * (0.16 + 0.08 * (9.0 * x).sin() * (7.0 * z).cos())
}

fn dunes() -> Mesh {
    let mut mesh = Plane3d::default()
        .mesh()
        .size(DUNES, DUNES)
        .subdivisions(HEIGHTS as u32 - 2)
        .build();
    change_positions(&mut mesh, |place| place.with_y(dune(place.x, place.z)));
    mesh.compute_smooth_normals();
    mesh
}

fn change_positions(mesh: &mut Mesh, change: impl Fn(Vec3) -> Vec3) {
    if let Some(VertexAttributeValues::Float32x3(positions)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION)
    {
        for position in positions {
            *position = change(Vec3::from(*position)).to_array();
        }
    }
}

fn spawn_cloths(mut shop: Workshop) {
    // A tea towel: off-white, with a thin stripe every so often along both ways.
    let weave = shop.weave(Weave::Plain, 5, |_, yarn| {
        if (29..33).contains(&yarn) {
            Color::srgb(0.50, 0.16, 0.22)
        } else {
            Color::srgb(0.93, 0.91, 0.86)
        }
    });
    let sheer = shop.paint(StandardMaterial {
        // So sheer that what is below is seen.
        base_color: Color::WHITE.with_alpha(0.42),
        alpha_mode: AlphaMode::Blend,
        ..weave
    });
    let side = shop.grid.0;
    for (name, place) in [("cloth", Vec3::ZERO), ("second cloth", SECOND)] {
        shop.commands.spawn((
            Name::new(name),
            Cloth::new(side, side, WIDTH / (side - 1) as f32)
                .lying()
                .centred(),
            Pins::none(),
            ClothMaterial {
                friction: 0.4,
                damping: 0.02,
                ..ClothMaterial::SILK
            },
            ClothSettings {
                particle_radius: 0.015,
                // So that it stays inside of its envelope as it lands.
                ..ClothSettings::substeps(36)
            },
            sheer.clone(),
            // Sheer fabric lets the light through.
            NotShadowCaster,
            ShowClothGizmos::nothing(),
            Transform::from_translation(place + Vec3::Y * HEIGHT),
        ));
    }
}
