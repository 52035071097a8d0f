//! The rail, the rings, the two halves of the curtain, and the walker.

use std::f32::consts::{FRAC_PI_2, PI};

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;

use crate::shared::{
    stage::{Grid, Shot, StagePlugin},
    woven::{Weave, woven},
};

/// Particles across a half of the curtain; down it there are half as many again.
pub const PARTICLES: u32 = 41;
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

/// When the walker comes out between the halves (s).
pub const PARTED_AT: f64 = 2.6;

/// From where the walker comes to, a little from the side.
pub const SHOT: Shot = Shot {
    from: Vec3::new(1.6, 1.66, 4.25),
    focus: Vec3::new(0.0, 1.12, 0.0),
    fov: 0.56,
};

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        let stage = StagePlugin {
            has_floor: true,
            light_from: Vec3::new(-3.5, 5.0, 4.5),
        };
        app.init_resource::<Grid>()
            .init_resource::<Rail>()
            .add_plugins((
                stage,
                DrapePlugins::default(),
                TransformInterpolationPlugin::default(),
            ))
            .add_systems(Startup, (spawn_rail, spawn_curtains, spawn_walker))
            .add_systems(FixedUpdate, (draw, walk).before(ClothSystems::Prepare));
    }
}

/// Whether the curtain is drawn open, and how far it is: 0 as the cloth is flat, 1 as it is asked for.
#[derive(Resource, Default)]
pub struct Rail {
    pub is_open: bool,
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

fn spawn_curtains(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    grid: Res<Grid>,
) {
    let columns = grid.0.max(2);
    let rows = columns * 3 / 2;
    let spacing = WIDTH / (columns - 1) as f32;
    let weave = woven(Weave::Twill, &mut images, 5, |runs_down, yarn| {
        match (runs_down, yarn % 32) {
            (true, 0..3) => Color::srgb(0.90, 0.76, 0.44),
            (true, _) => Color::srgb(0.05, 0.36, 0.38),
            (false, _) => Color::srgb(0.03, 0.25, 0.30),
        }
    });
    let fabric = materials.add(weave);
    let brass = materials.add(StandardMaterial {
        base_color: Color::srgb(0.86, 0.62, 0.24),
        perceptual_roughness: 0.35,
        metallic: 0.8,
        ..default()
    });
    let torus = meshes.add(Torus::new(0.026, 0.036));
    for side in [-1.0, 1.0] {
        let mut ring = |column: u32| {
            let ring = Ring {
                side,
                along: column as f32 / (columns - 1) as f32,
            };
            let place = Transform::from_translation(ring.place(1.0));
            let upright = Transform::from_xyz(0.0, 0.024, 0.0)
                .with_rotation(Quat::from_rotation_z(FRAC_PI_2));
            let mesh = (
                Mesh3d(torus.clone()),
                MeshMaterial3d(brass.clone()),
                upright,
            );
            let ring = (ring, place, Visibility::default(), TransformInterpolation);
            (
                Pin::Cell(0, column),
                commands.spawn(ring).with_child(mesh).id(),
            )
        };
        let last = columns - 1;
        let columns_with_rings = (0..last).step_by(RING as usize).chain([last]);
        let rings: Vec<_> = columns_with_rings.map(&mut ring).collect();
        // Columns run along +x: the other half is turned round, for both to begin at their walls.
        let wall = Vec3::new(side * wall(1.0), TOP, 0.0);
        let turn = Quat::from_rotation_y(if side < 0.0 { 0.0 } else { PI });
        commands.spawn((
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
            MeshMaterial3d(fabric.clone()),
            ShowClothGizmos::nothing(),
            Transform::from_translation(wall).with_rotation(turn),
        ));
    }
}

fn spawn_rail(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((Name::new("floor"), ClothCollider::plane()));
    let wood = materials.add(StandardMaterial {
        base_color: Color::srgb(0.36, 0.21, 0.11),
        perceptual_roughness: 0.6,
        ..default()
    });
    let length = 2.0 * CLOSED * WIDTH + 0.2;
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    let height = TOP + 0.046;
    commands.spawn((
        Mesh3d(meshes.add(Cylinder::new(0.018, length))),
        MeshMaterial3d(wood.clone()),
        Transform::from_xyz(0.0, height, 0.0).with_rotation(lying),
    ));
    for side in [-0.5, 0.5] {
        commands.spawn((
            Mesh3d(meshes.add(Sphere::new(0.036).mesh().uv(32, 16))),
            MeshMaterial3d(wood.clone()),
            Transform::from_xyz(side * length, height, 0.0),
        ));
        commands.spawn((
            Mesh3d(meshes.add(Cylinder::new(0.016, height))),
            MeshMaterial3d(wood.clone()),
            Transform::from_xyz(side * (length - 0.08), 0.5 * height, 0.0),
        ));
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
pub struct Walker {
    /// In m/s.
    pub speed: f32,
    towards: f32,
}

fn spawn_walker(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let clay = materials.add(StandardMaterial {
        base_color: Color::srgb(0.86, 0.42, 0.20),
        perceptual_roughness: 0.6,
        ..default()
    });
    let body = (
        ClothCollider::capsule(0.2, 0.95),
        Mesh3d(meshes.add(Capsule3d::new(0.2, 0.95))),
        MeshMaterial3d(clay.clone()),
        Transform::from_xyz(0.0, 0.72, 0.0),
    );
    let head = (
        ClothCollider::ball(0.15),
        Mesh3d(meshes.add(Sphere::new(0.15).mesh().uv(48, 24))),
        MeshMaterial3d(clay),
        Transform::from_xyz(0.0, 1.53, 0.0),
    );
    commands.spawn((
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
