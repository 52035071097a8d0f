//! The cloth, the bar that lets it down, and the count of what passes through itself.

use bevy::prelude::*;
use bevy_drape::{contact::intersections, plugin::ClothBuilt, prelude::*};

use crate::{
    figure::{Figure, FigurePlugin},
    shared::{
        stage::{Grid, Shot, StagePlugin},
        woven::{Weave, woven},
    },
};

/// Particles across the cloth; down it there are half as many again.
pub const PARTICLES: u32 = 24;
/// Width of the cloth (m).
const WIDTH: f32 = 0.6;
/// How high the bar begins, and where it lets go (m).
const TOP: f32 = 1.05;
const BOTTOM: f32 = 0.1;
/// How fast it sinks (m/s).
const SPEED: f32 = 0.45;
/// How far the middles of two layers are kept apart (m).
const THICKNESS: f32 = 0.006;
/// Ticks from one count to the next, in a window.
const TICKS_A_COUNT: u32 = 16;

/// From the side, where the folds show.
pub const SHOT: Shot = Shot {
    from: Vec3::new(0.72, 0.52, 1.0),
    focus: Vec3::new(0.0, 0.17, 0.0),
    fov: 0.5,
};

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        let stage = StagePlugin {
            has_floor: true,
            light_from: Vec3::new(-2.0, 3.2, 2.6),
        };
        app.add_plugins((stage, FigurePlugin, DrapePlugins::default()))
            .init_resource::<Crossings>()
            .add_systems(Startup, (spawn_bar, spawn_cloth).chain())
            .add_systems(
                FixedUpdate,
                (
                    sink.before(ClothSystems::Prepare),
                    count_crossings.after(ClothSystems::WriteBack),
                ),
            );
    }
}

/// Pairs of triangles that pass through each other.
#[derive(Resource, Default)]
pub struct Crossings {
    /// When they were counted last.
    pub now: usize,
    /// The most of any count.
    pub most: usize,
    /// How often they were counted.
    pub counts: u32,
    ticks: u32,
    /// Whether every tick is counted.
    pub is_thorough: bool,
}

/// What holds the upper edge.
#[derive(Component)]
pub struct Bar;

fn spawn_bar(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((Name::new("floor"), ClothCollider::plane()));
    let wood = materials.add(StandardMaterial {
        base_color: Color::srgb(0.42, 0.27, 0.15),
        perceptual_roughness: 0.7,
        ..default()
    });
    let along = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    commands.spawn((
        Name::new("bar"),
        Bar,
        Transform::from_xyz(0.0, TOP, 0.0),
        Visibility::default(),
        children![(
            Mesh3d(meshes.add(Cylinder::new(0.012, WIDTH + 0.16))),
            MeshMaterial3d(wood),
            Transform::from_xyz(0.0, 0.012, 0.0).with_rotation(along),
        )],
    ));
}

fn spawn_cloth(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    grid: Res<Grid>,
) {
    // Broad stripes across: each fold shows another.
    let weave = woven(Weave::WeftTwill, &mut images, 5, |runs_down, yarn| {
        match (runs_down, yarn / 16) {
            (true, _) | (false, 1) => Color::srgb(0.86, 0.84, 0.78),
            (false, 0 | 2) => Color::srgb(0.13, 0.36, 0.52),
            (false, _) => Color::srgb(0.80, 0.42, 0.20),
        }
    });
    let spacing = WIDTH / (grid.0 - 1) as f32;
    let rows = (3 * grid.0 / 2).max(2);
    commands.spawn((
        Name::new("cloth"),
        Cloth::new(grid.0, rows, spacing).centred(),
        Pins::none(),
        held(),
        contact(),
        ClothSettings {
            particle_radius: 0.003,
            ..default()
        },
        MeshMaterial3d(materials.add(weave)),
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.0, TOP - 0.5 * (rows - 1) as f32 * spacing, 0.0),
    ));
}

/// Of the cloth with itself.
pub fn contact() -> ClothSelfCollision {
    ClothSelfCollision {
        thickness: THICKNESS,
        friction: 0.4,
        ..default()
    }
}

/// By its upper edge, to the bar.
fn held() -> ClothAttachments {
    ClothAttachments::new([(Pin::Row(0), "bar")])
}

/// The bar sinks with what it holds, lets go above the floor, and goes up. A new cloth is held from the top again.
fn sink(
    bar: Single<&mut Transform, With<Bar>>,
    cloth: Single<(Entity, Ref<ClothParticles>, Has<ClothAttachments>), With<Cloth>>,
    time: Res<Time>,
    mut commands: Commands,
) {
    let mut bar = bar.into_inner();
    let (cloth, particles, is_held) = cloth.into_inner();
    if particles.is_empty() {
        bar.translation.y = TOP;
        commands.entity(cloth).insert(held());
        return;
    }
    let step = SPEED * time.delta_secs();
    if !is_held {
        // Out of the way.
        bar.translation.y = (bar.translation.y + step).min(TOP);
    } else if bar.translation.y > BOTTOM {
        bar.translation.y -= step;
    } else {
        commands.entity(cloth).remove::<ClothAttachments>();
    }
}

/// Counts the triangles that pass through each other, now and then: it takes longer than to simulate them.
fn count_crossings(
    cloths: Query<(&ClothBuilt, &ClothParticles)>,
    mut crossings: ResMut<Crossings>,
    mut figure: ResMut<Figure>,
) {
    crossings.ticks += 1;
    if !crossings.is_thorough && !crossings.ticks.is_multiple_of(TICKS_A_COUNT) {
        return;
    }
    crossings.now = cloths
        .iter()
        .map(|(built, particles)| {
            intersections(&[(built.surface(), particles.positions().collect())])
        })
        .sum();
    crossings.most = crossings.most.max(crossings.now);
    crossings.counts += 1;
    figure.is_good = crossings.now == 0;
    figure.lines = vec![format!("intersections: {}", crossings.now)];
}
