//! A banner that hangs from a bar, and a sword.

use std::f32::consts::FRAC_PI_2;

use bevy::{prelude::*, window::PrimaryWindow};
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};

/// Width and height of the banner, and the height of its upper edge (m).
const SIZE: Vec2 = Vec2::new(1.2, 1.7);
const TOP: f32 = 2.4;
/// The load that its threads bear (N/m).
const STRENGTH: f32 = 600.0;
/// Length of the sword's blade (m), and how long a slash takes (s).
const BLADE: f32 = 1.25;
const SLASH: f32 = 0.35;
/// How far the mouse cuts (m).
const FAR: f32 = 30.0;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(3.0, 5.0, 4.0),
        DrapePlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    .add_plugins(Keys(&[
        ("X", "held: the mouse cuts"),
        ("V", "slash with the sword"),
        ("H", "mend the banner"),
    ]))
    .insert_resource(ClothWind::gusty(Vec3::new(0.3, 0.0, 0.7)))
    .add_systems(Startup, (spawn_bar, spawn_banner, spawn_sword))
    .add_systems(FixedUpdate, swing.after(ClothSystems::WriteBack))
    .add_systems(
        Update,
        (scratch, press_keys).run_if(resource_exists::<ButtonInput<KeyCode>>),
    );
}

/// A sword that turns around its pommel, and how long it has been slashing (s).
#[derive(Component, Default)]
pub struct Sword {
    pub slashing: Option<f32>,
    last: Option<[Vec3; 2]>,
}

fn spawn_bar(mut shop: Workshop) {
    shop.commands
        .spawn((Name::new("floor"), ClothCollider::plane()));
    let wood = shop.rough(Color::srgb(0.36, 0.24, 0.15), 0.7);
    let brass = shop.brass(0.3);
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    let bar = Transform::from_xyz(0.0, TOP + 0.02, 0.0).with_rotation(lying);
    let bar = (
        shop.mesh(Cylinder::new(0.02, SIZE.x + 0.3)),
        wood.clone(),
        bar,
    );
    shop.commands.spawn(bar);
    let post = shop.mesh(Cylinder::new(0.035, TOP + 0.1));
    let knob = shop.mesh(Sphere::new(0.05).mesh().uv(32, 16));
    for side in [-1.0, 1.0] {
        let x = side * (0.5 * SIZE.x + 0.12);
        let place = Transform::from_xyz(x, 0.5 * TOP + 0.05, 0.0);
        shop.commands.spawn((post.clone(), wood.clone(), place));
        let place = Transform::from_xyz(x, TOP + 0.14, 0.0);
        shop.commands.spawn((knob.clone(), brass.clone(), place));
    }
}

fn spawn_banner(mut shop: Workshop) {
    let columns = shop.grid.0.max(8);
    let spacing = SIZE.x / (columns - 1) as f32;
    let rows = (SIZE.y / spacing).round() as u32 + 1;
    let fabric = shop.fabric(Weave::Twill, 1, |runs_down, yarn| match (runs_down, yarn) {
        (true, 0..6 | 58..64) | (false, 0..4 | 60..64) => Color::srgb(0.93, 0.76, 0.32),
        (true, 24..40) => Color::srgb(0.93, 0.88, 0.78),
        _ => Color::srgb(0.58, 0.10, 0.14),
    });
    shop.commands.spawn((
        Name::new("banner"),
        Cloth::new(columns, rows, spacing),
        ClothMaterial {
            areal_density: 0.2,
            ..ClothMaterial::COTTON
        },
        ClothTearing::new(STRENGTH),
        ClothSelfCollision::default(),
        fabric,
        ShowClothGizmos::nothing(),
        Transform::from_xyz(-0.5 * SIZE.x, TOP, 0.0),
    ));
}

fn spawn_sword(mut shop: Workshop) {
    let steel = shop.paint(StandardMaterial {
        base_color: Color::srgb(0.80, 0.82, 0.86),
        metallic: 0.9,
        perceptual_roughness: 0.25,
        ..default()
    });
    let brass = shop.brass(0.35);
    let leather = shop.rough(Color::srgb(0.20, 0.13, 0.10), 0.8);
    let parts = [
        (
            shop.mesh(Cuboid::new(0.045, BLADE, 0.008)),
            steel,
            0.16 + 0.5 * BLADE,
        ),
        (
            shop.mesh(Cuboid::new(0.22, 0.03, 0.03)),
            brass.clone(),
            0.15,
        ),
        (shop.mesh(Cylinder::new(0.016, 0.14)), leather, 0.07),
        (shop.mesh(Sphere::new(0.026).mesh().uv(32, 16)), brass, 0.0),
    ];
    let sword = (
        Name::new("sword"),
        Sword::default(),
        pose(0.0),
        TransformInterpolation,
        Visibility::default(),
    );
    let mut sword = shop.commands.spawn(sword);
    for (mesh, paint, along) in parts {
        sword.with_child((mesh, paint, Transform::from_xyz(0.0, along, 0.0)));
    }
}

/// The sword in a part of its slash, from 0 to 1. It points through the banner, and goes down from the upper right.
fn pose(part: f32) -> Transform {
    let smooth = part * part * (3.0 - 2.0 * part);
    let blade = Vec3::new(0.85, 0.75, -1.0).lerp(Vec3::new(-0.75, -0.15, -1.0), smooth);
    Transform::from_xyz(0.1, 0.85, 0.85)
        .with_rotation(Quat::from_rotation_arc(Vec3::Y, blade.normalize()))
}

/// Moves a sword that slashes, and cuts where it goes.
fn swing(mut swords: Query<(&mut Sword, &mut Transform)>, mut blade: ClothBlade, time: Res<Time>) {
    for (mut sword, mut place) in &mut swords {
        let Some(seconds) = sword.slashing else {
            continue;
        };
        let part = (seconds / SLASH).min(1.0);
        *place = pose(part);
        let now = [0.16, 0.16 + BLADE].map(|along| place.transform_point(along * Vec3::Y));
        if let Some(last) = sword.last.replace(now) {
            blade.sweep(last, now);
        }
        sword.slashing = Some(seconds + time.delta_secs()).filter(|_| part < 1.0);
        if sword.slashing.is_none() {
            sword.last = None;
        }
    }
}

/// The mouse cuts along what it is moved over, while its key is held.
fn scratch(
    keys: Res<ButtonInput<KeyCode>>,
    window: Option<Single<&Window, With<PrimaryWindow>>>,
    cameras: Query<(&Camera, &GlobalTransform), With<Camera3d>>,
    mut last: Local<Option<[Vec3; 2]>>,
    mut blade: ClothBlade,
) {
    let ray = window.and_then(|window| {
        let (camera, place) = cameras.iter().next()?;
        camera
            .viewport_to_world(place, window.cursor_position()?)
            .ok()
    });
    let now = ray.filter(|_| keys.pressed(KeyCode::KeyX));
    let now = now.map(|ray| [ray.origin, ray.get_point(FAR)]);
    if let (Some(last), Some(now)) = (*last, now) {
        blade.sweep(last, now);
    }
    *last = now;
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut swords: Query<&mut Sword>,
    mut tears: Query<&mut ClothTears>,
) {
    if keys.just_pressed(KeyCode::KeyV) {
        swords
            .iter_mut()
            .for_each(|mut sword| sword.slashing = Some(0.0));
    }
    if keys.just_pressed(KeyCode::KeyH) {
        tears
            .iter_mut()
            .for_each(|mut tears| *tears = ClothTears::default());
    }
}
