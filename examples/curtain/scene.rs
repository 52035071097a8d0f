//! The rail, the rings, the two halves of the curtain, and the walker.

use std::f32::consts::{FRAC_PI_2, PI};

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::arrows::up_down;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};

/// Width of the cloth of one half, and how much of it the rings leave when closed and when drawn open.
const WIDTH: f32 = 1.5;
const CLOSED: f32 = 0.62;
const OPEN: f32 = 0.22;
/// Gap between the halves (m).
const GAP: f32 = 0.01;
/// Height of the rings above the floor (m).
const TOP: f32 = 2.2;
/// Particles from one ring to the next.
const RING: u32 = 5;
/// How fast a curtain is drawn: its whole way in this many seconds.
const DRAWING: f32 = 1.2;
/// How far from the curtain the walker turns (m), and how fast it goes (m/s).
const TURNING: f32 = 2.3;
const SPEED: f32 = 1.1;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(-3.5, 5.0, 4.5),
        DrapePlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    .init_resource::<Rail>()
    .add_plugins(Keys(&[
        ("O", "open, close the curtain"),
        ("Up, Down", "faster, slower walker"),
    ]))
    .add_systems(Startup, (spawn_rail, spawn_curtains, spawn_walker))
    .add_systems(FixedUpdate, (draw, walk).before(ClothSystems::Prepare))
    .add_systems(Update, press_keys);
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut rail: ResMut<Rail>,
    mut walkers: Query<&mut Walker>,
) {
    rail.is_open ^= keys.just_pressed(KeyCode::KeyO);
    for mut walker in &mut walkers {
        walker.speed = (walker.speed + 0.25 * up_down(&keys)).clamp(0.0, 4.0);
    }
}

/// Whether the curtain is drawn open, and how far it is: 0 as the cloth is flat, 1 as it is asked for.
#[derive(Resource, Default)]
struct Rail {
    is_open: bool,
    share: Option<f32>,
}

/// A ring on the rail: which side it belongs to, −1 or 1, and how far along the cloth it is, from 0 at the wall to 1.
#[derive(Component)]
struct Ring {
    side: f32,
    along: f32,
}

impl Ring {
    /// Where it is (m) if the curtain takes this share of its width.
    fn place(&self, share: f32) -> Vec3 {
        let from_wall = self.along * share * WIDTH;
        Vec3::new(self.side * (wall(share) - from_wall), TOP, 0.0)
    }
}

/// How far the wall's end of a half is from the middle (m): farther out while the half is wider than when closed.
fn wall(share: f32) -> f32 {
    share.max(CLOSED) * WIDTH + 0.5 * GAP
}

fn spawn_curtains(mut shop: Workshop) {
    let columns = shop.grid.0.max(2);
    let rows = columns * 3 / 2;
    let spacing = WIDTH / (columns - 1) as f32;
    let fabric = shop.fabric(Weave::Twill, 5, |runs_down, yarn| {
        match (runs_down, yarn % 32) {
            (true, 0..3) => Color::srgb(0.90, 0.76, 0.44),
            (true, _) => Color::srgb(0.05, 0.36, 0.38),
            (false, _) => Color::srgb(0.03, 0.25, 0.30),
        }
    });
    let brass = shop.brass(0.35);
    let torus = shop.mesh(Torus::new(0.026, 0.036));
    for side in [-1.0, 1.0] {
        let mut ring = |column: u32| {
            let ring = Ring {
                side,
                along: column as f32 / (columns - 1) as f32,
            };
            let place = Transform::from_translation(ring.place(1.0));
            let upright = Transform::from_xyz(0.0, 0.024, 0.0)
                .with_rotation(Quat::from_rotation_z(FRAC_PI_2));
            let mesh = (torus.clone(), brass.clone(), upright);
            let ring = (ring, place, Visibility::default(), TransformInterpolation);
            let ring = shop.commands.spawn(ring).with_child(mesh).id();
            (Pin::Cell(0, column), ring)
        };
        let last = columns - 1;
        let columns_with_rings = (0..last).step_by(RING as usize).chain([last]);
        let rings: Vec<_> = columns_with_rings.map(&mut ring).collect();
        // Columns run along +x: the other half is turned round, for both to begin at their walls.
        let wall = Vec3::new(side * wall(1.0), TOP, 0.0);
        let turn = Quat::from_rotation_y(if side < 0.0 { 0.0 } else { PI });
        shop.commands.spawn((
            Name::new(if side < 0.0 {
                "left half"
            } else {
                "right half"
            }),
            Cloth::new(columns, rows, spacing),
            Pins::none(),
            ClothAttachments::new(rings),
            ClothMaterial {
                damping: 0.03,
                ..ClothMaterial::COTTON
            },
            ClothSettings::substeps(24),
            ClothSelfCollision::default(),
            fabric.clone(),
            ShowClothGizmos::nothing(),
            Transform::from_translation(wall).with_rotation(turn),
        ));
    }
}

fn spawn_rail(mut shop: Workshop) {
    shop.commands
        .spawn((Name::new("floor"), ClothCollider::plane()));
    let wood = shop.rough(Color::srgb(0.36, 0.21, 0.11), 0.6);
    let length = 2.0 * CLOSED * WIDTH + 0.2;
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    let height = TOP + 0.046;
    let mut part = |mesh: Mesh, place: Transform| {
        let mesh = shop.mesh(mesh);
        shop.commands.spawn((mesh, wood.clone(), place));
    };
    let rail = Transform::from_xyz(0.0, height, 0.0).with_rotation(lying);
    part(Cylinder::new(0.018, length).into(), rail);
    for side in [-0.5, 0.5] {
        let knob = Transform::from_xyz(side * length, height, 0.0);
        part(Sphere::new(0.036).mesh().uv(32, 16), knob);
        let post = Transform::from_xyz(side * (length - 0.08), 0.5 * height, 0.0);
        part(Cylinder::new(0.016, height).into(), post);
    }
}

/// Slides the rings along the rail.
fn draw(
    mut rail: ResMut<Rail>,
    mut rings: Query<(&Ring, &mut Transform)>,
    cloths: Query<&ClothParticles>,
    time: Res<Time>,
) {
    // New cloths are flat.
    if cloths.iter().any(ClothParticles::is_empty) {
        rail.share = None;
    }
    let share = rail.share.unwrap_or(1.0);
    let wanted = if rail.is_open { OPEN } else { CLOSED };
    let step = (1.0 - OPEN) * time.delta_secs() / DRAWING;
    let share = share + (wanted - share).clamp(-step, step);
    rail.share = Some(share);
    for (ring, mut place) in &mut rings {
        place.translation = ring.place(share);
    }
}

/// Who walks to and fro along z.
#[derive(Component)]
struct Walker {
    /// In m/s.
    speed: f32,
    towards: f32,
}

fn spawn_walker(mut shop: Workshop) {
    let clay = shop.rough(Color::srgb(0.86, 0.42, 0.20), 0.6);
    let body = (
        ClothCollider::capsule(0.2, 0.95),
        shop.mesh(Capsule3d::new(0.2, 0.95)),
        clay.clone(),
        Transform::from_xyz(0.0, 0.72, 0.0),
    );
    let head = (
        ClothCollider::ball(0.15),
        shop.mesh(Sphere::new(0.15).mesh().uv(48, 24)),
        clay,
        Transform::from_xyz(0.0, 1.53, 0.0),
    );
    shop.commands.spawn((
        Name::new("walker"),
        Walker {
            speed: SPEED,
            towards: 1.0,
        },
        TransformInterpolation,
        Transform::from_xyz(0.0, 0.0, -TURNING),
        Visibility::default(),
        children![body, head],
    ));
}

fn walk(mut walkers: Query<(&mut Walker, &mut Transform)>, time: Res<Time>) {
    for (mut walker, mut place) in &mut walkers {
        let z = &mut place.translation.z;
        if z.abs() > TURNING {
            walker.towards = -z.signum();
        }
        *z += walker.towards * walker.speed * time.delta_secs();
    }
}
