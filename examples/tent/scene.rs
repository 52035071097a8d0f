//! The pavilion: what holds it, its roof, its walls and its pennant.

use std::f32::consts::TAU;

use bevy::{math::Affine2, prelude::*};
use bevy_drape::prelude::*;

use crate::{
    shared::{
        stage::{Grid, Shot, StagePlugin},
        woven::{Weave, woven},
    },
    turned::turned,
};

/// Particles from the peak to the hem of the roof.
pub const PARTICLES: u32 = 18;
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

/// When the picture is drawn (s).
pub const DRAWN_AT: f64 = 5.2;

/// All of it, from somebody's height.
pub const SHOT: Shot = Shot {
    from: Vec3::new(2.6, 1.6, 8.6),
    focus: Vec3::new(0.15, 1.88, 0.0),
    fov: 0.50,
};

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        let stage = StagePlugin {
            has_floor: true,
            light_from: Vec3::new(-3.0, 5.0, 5.5),
        };
        app.init_resource::<Grid>()
            .insert_resource(wind())
            .add_plugins((stage, DrapePlugins::default()))
            .add_systems(Startup, (spawn_frame, spawn_cloth).chain());
    }
}

/// A strong breeze, from the left and a little from the front: it blows in at the door.
fn wind() -> ClothWind {
    ClothWind {
        gusts: 0.5,
        turbulence: 0.4,
        turbulence_length: 1.2,
        ..ClothWind::new(Vec3::new(6.5, 0.0, -3.0))
    }
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

fn spawn_frame(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let wood = materials.add(StandardMaterial {
        base_color: Color::srgb(0.42, 0.29, 0.17),
        perceptual_roughness: 0.7,
        ..default()
    });
    let hemp = materials.add(Color::srgb(0.74, 0.66, 0.48));
    let gold = materials.add(StandardMaterial {
        base_color: Color::srgb(0.86, 0.62, 0.24),
        perceptual_roughness: 0.3,
        metallic: 0.8,
        ..default()
    });
    let mut stick = |from: Vec3, to: Vec3, radius: f32, material: &Handle<StandardMaterial>| {
        (
            Mesh3d(meshes.add(Cylinder::new(radius, from.distance(to)))),
            MeshMaterial3d(material.clone()),
            Transform::from_translation(from.midpoint(to)).with_rotation(Quat::from_rotation_arc(
                Vec3::Y,
                (to - from).normalize_or(Vec3::Y),
            )),
        )
    };
    let top = Vec3::Y * (PEAK[1] + 0.62);
    commands.spawn((Name::new("mast"), Mast, stick(Vec3::ZERO, top, 0.03, &wood)));
    for pole in 0..POLES {
        let out = towards(pole);
        let head = out * (EAVES[0] - 0.02) + Vec3::Y * EAVES[1];
        let foot = out * (EAVES[0] - 0.02);
        commands.spawn(stick(foot, head, 0.018, &wood));
        let peg = out * 2.75;
        commands.spawn(stick(head, peg + Vec3::Y * 0.05, 0.007, &hemp));
        let driven = stick(
            peg - out * 0.04,
            peg + out * 0.05 + Vec3::Y * 0.13,
            0.018,
            &wood,
        );
        commands.spawn(driven);
    }
    commands.spawn((
        Mesh3d(meshes.add(Sphere::new(0.06).mesh().uv(32, 16))),
        MeshMaterial3d(gold),
        Transform::from_translation(top + Vec3::Y * 0.04),
    ));
    commands.spawn((Name::new("ground"), ClothCollider::plane()));
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

fn spawn_cloth(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mast: Single<Entity, With<Mast>>,
    grid: Res<Grid>,
) {
    let slope = Vec2::from(PEAK).distance(EAVES.into());
    let spacing = (slope + EAVES[1] - HEM[1]) / grid.0.max(4) as f32;
    // As many between two poles as are about as far apart as those from ring to ring.
    let between = (TAU * EAVES[0] / POLES as f32 / spacing).ceil() as u32;
    let [red, cream] = [Color::srgb(0.60, 0.05, 0.07), Color::srgb(1.0, 1.0, 0.92)];
    // One gore in either color by turns.
    let mut stripes = |colors: [Color; 2], gores: u32| {
        let warp = Color::srgb(0.86, 0.62, 0.52);
        let woven = woven(Weave::WeftTwill, &mut images, 1, |runs_down, yarn| {
            match (runs_down, yarn) {
                (true, _) => warp,
                (false, 0..32) => colors[0],
                (false, _) => colors[1],
            }
        });
        MeshMaterial3d(materials.add(StandardMaterial {
            uv_transform: Affine2::from_scale(Vec2::new(4.0, gores as f32 / 2.0)),
            ..woven
        }))
    };
    let canvas = ClothMaterial {
        damping: 0.04,
        areal_density: 0.25,
        ..ClothMaterial::CANVAS
    };
    let settings = ClothSettings::substeps(20);

    // Sewn to the mast's ring above, held by each pole's head at the eaves, and loose below.
    let roof = Pin::at_rest(|place| {
        let is_at_eaves = (place.y - EAVES[1]).abs() < 1.0e-3;
        place.xz().length() < PEAK[0] + 1.0e-3 || (is_at_eaves && is_at_pole(place))
    });
    let shape = turned(&profile(&[PEAK, EAVES, HEM], spacing), between * POLES, TAU);
    commands.spawn((
        Name::new("roof"),
        Cloth::mesh(),
        Mesh3d(meshes.add(shape)),
        Pins::new([roof]),
        canvas,
        settings,
        stripes([red, cream], POLES),
        ShowClothGizmos::nothing(),
    ));

    // From one side of the door to the other: on a rope above, and by a peg at each pole.
    let gores = POLES - (DOOR[1] - DOOR[0]);
    let top = [EAVES[0] - INSIDE, EAVES[1] - 0.02];
    let walls = Pin::at_rest(move |place| {
        place.y > top[1] - 1.0e-3 || (place.y < PEGS[1] + 1.0e-3 && is_at_pole(place))
    });
    let shape = turned(
        &profile(&[top, PEGS], spacing),
        between * gores,
        TAU * gores as f32 / POLES as f32,
    );
    let begin = TAU * DOOR[1] as f32 / POLES as f32;
    commands.spawn((
        Name::new("walls"),
        Cloth::mesh(),
        Mesh3d(meshes.add(shape)),
        Pins::new([walls]),
        canvas,
        settings,
        stripes([red, cream], gores),
        ShowClothGizmos::nothing(),
        // The other way around than angles from +x to +z.
        Transform::from_rotation(Quat::from_rotation_y(-begin)),
    ));

    commands.spawn((
        Name::new("pennant"),
        Cloth::new(24, 12, 0.9 / 23.0),
        Pins::none(),
        ClothAttachments::new([(Pin::Column(0), *mast)]),
        ClothMaterial::SILK,
        settings,
        MeshMaterial3d(materials.add(fabric(Color::srgb(0.10, 0.22, 0.50)))),
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.03, PEAK[1] + 0.56, 0.0),
    ));
}
