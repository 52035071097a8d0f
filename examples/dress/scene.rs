//! The figure on its stand, and its skirt.

use std::f32::consts::TAU;

use bevy::{math::Affine2, prelude::*};
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};
use examples_shared::{arrows::up_down, surfaces::turned};

/// Particles around the skirt for one from its waist to its hem.
const AROUND: u32 = 5;
/// Height and radius of the waist, and radius of the hem and how far below the waist it is as the skirt is cut (m). Hardly wider than
/// where it flies: all that is wider would hang in the air in folds that are too sharp for the mesh.
const WAIST: f32 = 1.02;
const WAIST_RADIUS: f32 = 0.125;
const HEM_RADIUS: f32 = 0.58;
const DROP: f32 = 0.42;
/// Thickness of the cloth (m), unless that is too much for the spacing at the waist.
const THICKNESS: f32 = 0.003;
/// How fast the figure turns (rad/s), and how much faster it gets in a second (rad/s²).
const SPEED: f32 = 6.0;
const PICK_UP: f32 = 5.0;
/// How long it turns and stands in turns (s).
const TWIRL: f32 = 4.0;
/// Radii of the figure at heights below and above its waist (m).
const BODY: [[f32; 2]; 15] = [
    [0.0, -0.30],
    [0.09, -0.295],
    [0.140, -0.26],
    [0.160, -0.20],
    [0.162, -0.14],
    [0.150, -0.08],
    [0.128, -0.02],
    [0.121, 0.02],
    [0.132, 0.10],
    [0.155, 0.20],
    [0.163, 0.28],
    [0.150, 0.36],
    [0.105, 0.43],
    [0.058, 0.47],
    [0.050, 0.54],
];

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(-3.0, 4.0, 3.5),
        DrapePlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    .add_plugins(Keys(&[
        ("T", "spin, stand still"),
        ("Up, Down", "spin faster, slower"),
    ]))
    .add_systems(Startup, (spawn_figure, spawn_stand))
    .add_systems(FixedUpdate, turn.before(ClothSystems::Prepare))
    .add_systems(Update, press_keys);
}

fn press_keys(keys: Res<ButtonInput<KeyCode>>, mut figures: Query<&mut Figure>) {
    for mut figure in &mut figures {
        figure.twirls ^= keys.just_pressed(KeyCode::KeyT);
        figure.speed = (figure.speed + 0.5 * up_down(&keys)).clamp(0.0, 10.0);
    }
}

/// What turns.
#[derive(Component)]
struct Figure {
    /// How fast when it twirls (rad/s).
    speed: f32,
    /// Whether it twirls at all.
    twirls: bool,
    /// How fast now (rad/s).
    now: f32,
}

/// A flared skirt: a cone of cloth from its waist down to its hem, of this many rings of triangles.
fn skirt(rings: u32) -> Mesh {
    let profile: Vec<[f32; 2]> = (0..=rings)
        .map(|ring| ring as f32 / rings as f32)
        .map(|part| [WAIST_RADIUS.lerp(HEM_RADIUS, part), -DROP * part])
        .collect();
    turned(&profile, AROUND * rings, TAU)
}

fn spawn_figure(mut shop: Workshop) {
    let linen = Color::srgb(0.80, 0.73, 0.62);
    let waist = Transform::from_xyz(0.0, WAIST, 0.0);
    let body = (
        shop.mesh(turned(&BODY, 64, TAU)),
        shop.fabric(Weave::Plain, 5, |_, _| linen),
    );
    // What the skirt touches: hips, and what would be legs.
    let hips = (
        ClothCollider::ball(0.165),
        Transform::from_xyz(0.0, -0.16, 0.0),
    );
    let legs = (
        ClothCollider::capsule(0.1, 0.3),
        Transform::from_xyz(0.0, -0.42, 0.0),
    );
    let figure = Figure {
        speed: SPEED,
        twirls: true,
        now: 0.0,
    };
    let figure = shop
        .commands
        .spawn((Name::new("figure"), figure, TransformInterpolation, waist))
        .insert((body, children![hips, legs]))
        .id();
    // Bands of colour around the hem.
    let cloth = shop.weave(Weave::Twill, 1, |runs_down, yarn| match (runs_down, yarn) {
        (true, 42..46 | 56..59) => Color::srgb(0.95, 0.86, 0.66),
        (true, 46..56) => Color::srgb(0.12, 0.22, 0.46),
        (true, _) => Color::srgb(0.74, 0.10, 0.20),
        (false, _) => Color::srgb(0.48, 0.06, 0.16),
    });
    let cloth = shop.paint(StandardMaterial {
        // As long around as from the waist to the hem.
        uv_transform: Affine2::from_scale(Vec2::new(1.0, 6.0)),
        ..cloth
    });
    let rings = shop.grid.0;
    let mesh = shop.mesh(skirt(rings));
    let spacing_at_waist = TAU * WAIST_RADIUS / (AROUND * rings) as f32;
    let inner_edge = Pin::at_rest(|place| place.length() < WAIST_RADIUS + 1.0e-3);
    shop.commands.spawn((
        Name::new("skirt"),
        Cloth::mesh(),
        mesh,
        Pins::none(),
        ClothAttachments::new([(inner_edge, figure)]),
        ClothMaterial {
            damping: 0.03,
            ..ClothMaterial::COTTON
        },
        ClothSettings::substeps(24),
        ClothSelfCollision::of_thickness(THICKNESS.min(0.4 * spacing_at_waist)),
        ShowClothGizmos::nothing(),
        cloth,
        waist,
    ));
}

fn spawn_stand(mut shop: Workshop) {
    let wood = shop.rough(Color::srgb(0.36, 0.20, 0.10), 0.5);
    let foot = [
        [0.0, 0.045],
        [0.03, 0.045],
        [0.05, 0.03],
        [0.24, 0.02],
        [0.25, 0.0],
    ];
    let cap = [
        [0.055, 0.0],
        [0.05, 0.02],
        [0.02, 0.035],
        [0.026, 0.06],
        [0.0, 0.085],
    ];
    let mut part = |mesh: Mesh, height: f32| {
        let mesh = shop.mesh(mesh);
        let place = Transform::from_xyz(0.0, height, 0.0);
        shop.commands.spawn((mesh, wood.clone(), place));
    };
    part(turned(&foot, 64, TAU), 0.0);
    part(Cylinder::new(0.02, 0.75).mesh().build(), 0.4);
    part(turned(&cap, 64, TAU), WAIST + 0.54);
}

/// Twirls for some time, and stands for as long.
fn turn(mut figures: Query<(&mut Figure, &mut Transform)>, time: Res<Time>) {
    let step = PICK_UP * time.delta_secs();
    let is_its_turn = time.elapsed_secs() % (2.0 * TWIRL) < TWIRL;
    for (mut figure, mut place) in &mut figures {
        let wanted = if figure.twirls && is_its_turn {
            figure.speed
        } else {
            0.0
        };
        figure.now += (wanted - figure.now).clamp(-step, step);
        place.rotate_y(figure.now * time.delta_secs());
    }
}
