//! The three cloths, what they hang from, and what they lie on.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::{gltf::GltfAssetLabel, math::Affine2, prelude::*};
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::workshop::{Weave, Workshop};

use crate::models;

/// The tent, as a modelling program exports it: metres, y up, the ground at 0.
const TENT: &str = "models/tent.glb";

const POLE: Vec3 = Vec3::new(-3.4, 0.0, 0.1);
const YARD: Vec3 = Vec3::new(-3.4, 2.1, 0.15);
const PERSON: Vec3 = Vec3::new(-0.6, 0.0, 0.5);
const CAMP: Vec3 = Vec3::new(3.0, 0.0, -0.2);

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(-3.5, 5.0, 4.0),
        DrapePlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    .add_systems(
        Startup,
        (spawn_floor, spawn_pennant, spawn_poncho, spawn_tent),
    )
    .add_systems(FixedUpdate, (sway, press).before(ClothSystems::Prepare));
}

fn spawn_floor(mut commands: Commands) {
    commands.spawn((Name::new("floor"), ClothCollider::plane()));
}

/// What sways.
#[derive(Component)]
struct Sways;

fn spawn_pennant(mut shop: Workshop) {
    let wood = shop.paint(Color::srgb(0.45, 0.32, 0.2));
    let pole = (
        shop.mesh(Cylinder::new(0.025, 2.3)),
        wood.clone(),
        Transform::from_translation(POLE + Vec3::Y * 1.15),
    );
    shop.commands.spawn(pole);
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    let yard = (
        Name::new("yard"),
        Sways,
        TransformInterpolation,
        shop.mesh(Cylinder::new(0.018, 0.95)),
        wood,
        Transform::from_translation(YARD).with_rotation(lying),
    );
    shop.commands.spawn(yard);
    let red = shop.paint(fabric(Color::srgb(0.72, 0.07, 0.12)));
    // Positions and triangles as the game has them; its upper edge follows the entity that is called "yard".
    let (positions, triangles) = models::pennant(0.8, 1.5, shop.grid.0);
    let edge = Pin::at_rest(|place| place.x < 1.0e-3);
    shop.commands.spawn((
        Name::new("pennant"),
        Cloth::triangles(positions, triangles),
        Pins::none(),
        ClothAttachments::new([(edge, "yard")]),
        ClothMaterial {
            damping: 0.02,
            ..ClothMaterial::SILK
        },
        ClothSettings::substeps(30),
        ShowClothGizmos::nothing(),
        red,
        // Its point down.
        Transform::from_translation(YARD + Vec3::X * 0.4).with_rotation(lying.inverse()),
    ));
}

/// To and fro around the pole, and up and down.
fn sway(mut yards: Query<&mut Transform, With<Sways>>, time: Res<Time>) {
    let seconds = time.elapsed_secs();
    for mut yard in &mut yards {
        let lean = 0.08 * (TAU * seconds / 2.5).sin();
        let turn = 0.7 * (TAU * seconds / 5.0).sin();
        yard.rotation = Quat::from_rotation_y(turn) * Quat::from_rotation_z(FRAC_PI_2 + lean);
    }
}

fn spawn_poncho(mut shop: Workshop) {
    let skin = shop.paint(Color::srgb(0.55, 0.57, 0.6));
    let mut body = |name: &'static str, collider, mesh: Mesh, place: Transform| {
        let look = (shop.mesh(mesh), skin.clone());
        shop.commands
            .spawn((Name::new(name), collider, look, place));
    };
    let at = |x: f32, y: f32| Transform::from_translation(PERSON + Vec3::new(x, y, 0.0));
    body(
        "head",
        ClothCollider::ball(0.12),
        Sphere::new(0.12).mesh().uv(48, 24),
        at(0.0, 1.64),
    );
    body(
        "neck",
        ClothCollider::capsule(0.06, 0.2),
        Capsule3d::new(0.06, 0.2).into(),
        at(0.0, 1.46),
    );
    let lying = at(0.0, 1.34).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
    body(
        "shoulders",
        ClothCollider::capsule(0.1, 0.34),
        Capsule3d::new(0.1, 0.34).into(),
        lying,
    );
    body(
        "chest",
        ClothCollider::capsule(0.17, 0.7),
        Capsule3d::new(0.17, 0.7).into(),
        at(0.0, 0.86),
    );
    // The mesh asset of the entity is the cloth.
    let rings = shop.grid.0;
    let poncho = shop.mesh(models::poncho(1.5, 0.17, rings));
    // Rings of colour from the hole to the hem, between light yarns.
    let colors = [
        [196, 86, 42],
        [236, 200, 120],
        [58, 94, 120],
        [236, 226, 206],
        [150, 44, 48],
        [58, 94, 120],
    ];
    let weave = shop.weave(Weave::Herringbone, 1, |runs_down, yarn| {
        let [r, g, b] = colors[(yarn as usize / 6) % colors.len()];
        if runs_down {
            Color::srgb_u8(226, 216, 196)
        } else {
            Color::srgb_u8(r, g, b)
        }
    });
    let weave = shop.paint(StandardMaterial {
        // As wide around as from the hole to the hem.
        uv_transform: Affine2::from_scale(Vec2::new(12.0, 1.5)),
        // The mesh has no tangents.
        normal_map_texture: None,
        ..weave
    });
    shop.commands.spawn((
        Name::new("poncho"),
        Cloth::mesh(),
        poncho,
        ClothMaterial {
            damping: 0.08,
            friction: 0.6,
            // Loosely woven.
            bend_rigidity: 3.0e-6,
            ..ClothMaterial::COTTON
        },
        ClothSettings {
            particle_radius: 0.012,
            ..ClothSettings::substeps(110)
        },
        // Nobody is thin enough to slip between particles.
        NarrowPhase::Particles,
        ShowClothGizmos::nothing(),
        weave,
        // Around the neck.
        Transform::from_translation(PERSON + Vec3::Y * 1.47),
    ));
}

/// A ball that presses into the tent's side now and then.
#[derive(Component)]
struct Presses;

fn spawn_tent(mut shop: Workshop, assets: Res<AssetServer>) {
    let primitive = |mesh| {
        let label = GltfAssetLabel::Primitive { mesh, primitive: 0 };
        Mesh3d(assets.load(label.from_asset(TENT)))
    };
    let material = |material| {
        MeshMaterial3d(assets.load::<StandardMaterial>(format!("{TENT}#Material{material}/std")))
    };
    let place = Transform::from_translation(CAMP).with_rotation(Quat::from_rotation_y(0.45));
    // It waits for its asset. The artist has painted what is pinned: pegs and ridge, in the alpha of the vertex colours.
    shop.commands.spawn((
        Name::new("tent"),
        Cloth::mesh(),
        primitive(0),
        Pins::new([Pin::color(3, 0.5)]),
        ClothMaterial {
            damping: 0.04,
            ..ClothMaterial::CANVAS
        },
        ClothSettings::substeps(36),
        ShowClothGizmos::nothing(),
        material(0),
        place,
    ));
    shop.commands
        .spawn((Name::new("poles"), primitive(1), material(1), place));
    let ball = (
        Name::new("ball"),
        Presses,
        TransformInterpolation,
        ClothCollider::ball(0.24),
        shop.mesh(Sphere::new(0.24).mesh().uv(64, 32)),
        shop.paint(Color::srgb(0.92, 0.42, 0.04)),
        Transform::from_translation(CAMP + Vec3::Y),
    );
    shop.commands.spawn(ball);
}

/// Towards the tent's front side and back, every six seconds.
fn press(mut balls: Query<&mut Transform, With<Presses>>, time: Res<Time>) {
    let away = 0.95 - 0.19 * (1.0 - (TAU * time.elapsed_secs() / 6.0).cos());
    for mut ball in &mut balls {
        ball.translation = CAMP + Quat::from_rotation_y(0.45) * Vec3::new(0.1, 0.6, away);
    }
}
