//! The figure on its stand, and its skirt.

use std::f32::consts::TAU;

use bevy::{math::Affine2, prelude::*};
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;

use crate::{
    models::{AROUND, skirt},
    shared::{
        stage::{Grid, Shot, StagePlugin},
        woven::{Weave, woven},
    },
    turned::turned,
};

/// Particles from the waist to the hem.
pub const PARTICLES: u32 = 18;
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

/// When the skirt flies (s).
pub const DRAWN_AT: f64 = 3.4;

/// All of the figure, from a little above its waist.
pub const SHOT: Shot = Shot {
    from: Vec3::new(0.8, 1.35, 2.85),
    focus: Vec3::new(0.0, 0.87, 0.0),
    fov: 0.52,
};

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        let stage = StagePlugin {
            has_floor: true,
            light_from: Vec3::new(-3.0, 4.0, 3.5),
        };
        app.init_resource::<Grid>()
            .add_plugins((
                stage,
                DrapePlugins::default(),
                TransformInterpolationPlugin::default(),
            ))
            .add_systems(Startup, (spawn_figure, spawn_stand))
            .add_systems(FixedUpdate, turn.before(ClothSystems::Prepare));
    }
}

/// What turns.
#[derive(Component)]
pub struct Figure {
    /// How fast when it twirls (rad/s).
    pub speed: f32,
    /// Whether it twirls at all.
    pub twirls: bool,
    /// How fast now (rad/s).
    now: f32,
}

fn spawn_figure(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    grid: Res<Grid>,
) {
    let linen = woven(Weave::Plain, &mut images, 5, |_, _| {
        Color::srgb(0.80, 0.73, 0.62)
    });
    let waist = Transform::from_xyz(0.0, WAIST, 0.0);
    let body = (
        Mesh3d(meshes.add(turned(&BODY, 64, TAU))),
        MeshMaterial3d(materials.add(linen)),
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
    let figure = commands
        .spawn((Name::new("figure"), figure, TransformInterpolation, waist))
        .insert((body, children![hips, legs]))
        .id();
    // Bands of colour around the hem.
    let cloth = woven(Weave::Twill, &mut images, 1, |runs_down, yarn| {
        match (runs_down, yarn) {
            (true, 42..46 | 56..59) => Color::srgb(0.95, 0.86, 0.66),
            (true, 46..56) => Color::srgb(0.12, 0.22, 0.46),
            (true, _) => Color::srgb(0.74, 0.10, 0.20),
            (false, _) => Color::srgb(0.48, 0.06, 0.16),
        }
    });
    let spacing_at_waist = TAU * WAIST_RADIUS / (AROUND * grid.0) as f32;
    let inner_edge = Pin::at_rest(|place| place.length() < WAIST_RADIUS + 1.0e-3);
    commands.spawn((
        Name::new("skirt"),
        Cloth::mesh(),
        Mesh3d(meshes.add(skirt(WAIST_RADIUS, HEM_RADIUS, DROP, grid.0))),
        Pins::none(),
        ClothAttachments::new([(inner_edge, figure)]),
        ClothMaterial {
            damping: 0.03,
            ..ClothMaterial::COTTON
        },
        ClothSettings::substeps(24),
        ClothSelfCollision::of_thickness(THICKNESS.min(0.4 * spacing_at_waist)),
        ShowClothGizmos::nothing(),
        MeshMaterial3d(materials.add(StandardMaterial {
            // As long around as from the waist to the hem.
            uv_transform: Affine2::from_scale(Vec2::new(1.0, 6.0)),
            ..cloth
        })),
        waist,
    ));
}

fn spawn_stand(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let wood = materials.add(StandardMaterial {
        base_color: Color::srgb(0.36, 0.20, 0.10),
        perceptual_roughness: 0.5,
        ..default()
    });
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
        let place = Transform::from_xyz(0.0, height, 0.0);
        commands.spawn((
            Mesh3d(meshes.add(mesh)),
            MeshMaterial3d(wood.clone()),
            place,
        ));
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
