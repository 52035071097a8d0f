//! The pavilion: what holds it, its roof, its walls and its pennant.

use std::f32::consts::TAU;

use bevy::{math::Affine2, prelude::*};
use bevy_drape::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::workshop::{Paint, Weave, Workshop};
use examples_shared::{surfaces::turned, windy};

/// Poles around it: the roof hangs between them.
const POLES: u32 = 12;
/// Radius and height of the peak, of the eaves and of the hem that hangs below them, and of the pegs (m).
const PEAK: [f32; 2] = [0.07, 3.05];
const EAVES: [f32; 2] = [1.60, 2.0];
const HEM: [f32; 2] = [1.62, 1.74];
const PEGS: [f32; 2] = [1.78, 0.02];
/// The walls hang a little inside of the eaves (m), and are open between these poles.
const INSIDE: f32 = 0.05;
const DOOR: [u32; 2] = [2, 4];

/// The scene, without a camera.
pub fn build(app: &mut App) {
    let stage = StagePlugin::lit_from(-3.0, 5.0, 5.5);
    app.add_plugins((stage, DrapePlugins::default(), windy::KeysPlugin))
        // A strong breeze, from the left and a little from the front: it blows in at the door.
        .insert_resource(ClothWind {
            gusts: 0.5,
            turbulence: 0.4,
            turbulence_length: 1.2,
            ..ClothWind::new(Vec3::new(6.5, 0.0, -3.0))
        })
        .add_systems(Startup, (spawn_frame, spawn_cloth).chain());
}

/// What the pennant is attached to.
#[derive(Component)]
struct Mast;

/// From the middle to the pole of this number.
fn towards(pole: u32) -> Vec3 {
    let (sin, cos) = (TAU * pole as f32 / POLES as f32).sin_cos();
    Vec3::new(cos, 0.0, sin)
}

/// Whether a particle of roof or walls, at rest, is where a pole is.
fn is_at_pole(place: Vec3) -> bool {
    let turn = place.z.atan2(place.x) / TAU * POLES as f32;
    (turn - turn.round()).abs() < 0.02
}

fn spawn_frame(mut shop: Workshop) {
    let wood = shop.rough(Color::srgb(0.42, 0.29, 0.17), 0.7);
    let hemp = shop.paint(Color::srgb(0.74, 0.66, 0.48));
    let mut stick = |from: Vec3, to: Vec3, radius: f32, paint: &Paint| {
        let mesh = shop.mesh(Cylinder::new(radius, from.distance(to)));
        let upwards = (to - from).normalize_or(Vec3::Y);
        let place = Transform::from_translation(from.midpoint(to))
            .with_rotation(Quat::from_rotation_arc(Vec3::Y, upwards));
        shop.commands.spawn((mesh, paint.clone(), place)).id()
    };
    let top = Vec3::Y * (PEAK[1] + 0.62);
    let mast = stick(Vec3::ZERO, top, 0.03, &wood);
    for pole in 0..POLES {
        let out = towards(pole);
        let foot = out * (EAVES[0] - 0.02);
        let head = foot + Vec3::Y * EAVES[1];
        stick(foot, head, 0.018, &wood);
        let peg = out * 2.75;
        stick(head, peg + Vec3::Y * 0.05, 0.007, &hemp);
        let [low, high] = [peg - out * 0.04, peg + out * 0.05 + Vec3::Y * 0.13];
        stick(low, high, 0.018, &wood);
    }
    shop.commands.entity(mast).insert((Name::new("mast"), Mast));
    let knob = (
        shop.mesh(Sphere::new(0.06).mesh().uv(32, 16)),
        shop.brass(0.3),
        Transform::from_translation(top + Vec3::Y * 0.04),
    );
    shop.commands.spawn(knob);
    shop.commands
        .spawn((Name::new("ground"), ClothCollider::plane()));
}

/// Circles from one to the next of `corners`, no further apart than `spacing` (m).
fn profile(corners: &[[f32; 2]], spacing: f32) -> Vec<[f32; 2]> {
    let mut circles = vec![corners[0]];
    for pair in corners.windows(2) {
        let [from, to] = [Vec2::from(pair[0]), Vec2::from(pair[1])];
        let steps = (from.distance(to) / spacing).ceil().max(1.0);
        let between = (1..=steps as u32).map(|step| from.lerp(to, step as f32 / steps).to_array());
        circles.extend(between);
    }
    circles
}

fn spawn_cloth(mut shop: Workshop, mast: Single<Entity, With<Mast>>) {
    let slope = Vec2::from(PEAK).distance(EAVES.into());
    let spacing = (slope + EAVES[1] - HEM[1]) / shop.grid.0.max(4) as f32;
    // As many between two poles as are about as far apart as those from ring to ring.
    let between = (TAU * EAVES[0] / POLES as f32 / spacing).ceil() as u32;
    let settings = ClothSettings::substeps(20);
    let mut spawn = |name: &'static str, corners: &[[f32; 2]], gores: u32, pin: Pin| {
        let arc = TAU * gores as f32 / POLES as f32;
        let shape = turned(&profile(corners, spacing), between * gores, arc);
        // One gore in either colour by turns.
        let stripes = shop.weave(Weave::WeftTwill, 1, |runs_down, yarn| {
            match (runs_down, yarn) {
                (true, _) => Color::srgb(0.86, 0.62, 0.52),
                (false, 0..32) => Color::srgb(0.60, 0.05, 0.07),
                (false, _) => Color::srgb(1.0, 1.0, 0.92),
            }
        });
        let parts = (
            shop.mesh(shape),
            shop.paint(StandardMaterial {
                uv_transform: Affine2::from_scale(Vec2::new(4.0, gores as f32 / 2.0)),
                ..stripes
            }),
        );
        let cloth = shop.commands.spawn((
            Name::new(name),
            Cloth::mesh(),
            parts,
            Pins::new([pin]),
            ClothMaterial {
                damping: 0.04,
                areal_density: 0.25,
                ..ClothMaterial::CANVAS
            },
            settings,
            ShowClothGizmos::nothing(),
        ));
        cloth.id()
    };
    // Sewn to the mast's ring above, held by each pole's head at the eaves, and loose below.
    let roof = Pin::at_rest(|place| {
        let is_at_eaves = (place.y - EAVES[1]).abs() < 1.0e-3;
        place.xz().length() < PEAK[0] + 1.0e-3 || (is_at_eaves && is_at_pole(place))
    });
    spawn("roof", &[PEAK, EAVES, HEM], POLES, roof);
    // From one side of the door to the other: on a rope above, and by a peg at each pole.
    let top = [EAVES[0] - INSIDE, EAVES[1] - 0.02];
    let walls = Pin::at_rest(move |place| {
        place.y > top[1] - 1.0e-3 || (place.y < PEGS[1] + 1.0e-3 && is_at_pole(place))
    });
    let gores = POLES - (DOOR[1] - DOOR[0]);
    let walls = spawn("walls", &[top, PEGS], gores, walls);
    // The other way around than angles from +x to +z.
    let begin = Quat::from_rotation_y(-TAU * DOOR[1] as f32 / POLES as f32);
    shop.commands
        .entity(walls)
        .insert(Transform::from_rotation(begin));

    let blue = shop.paint(fabric(Color::srgb(0.10, 0.22, 0.50)));
    shop.commands.spawn((
        Name::new("pennant"),
        Cloth::new(24, 12, 0.9 / 23.0),
        Pins::none(),
        ClothAttachments::new([(Pin::Column(0), *mast)]),
        ClothMaterial::SILK,
        settings,
        blue,
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.03, PEAK[1] + 0.56, 0.0),
    ));
}
