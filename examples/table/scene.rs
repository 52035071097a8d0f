//! The table, its cloth, and the hand that pulls it away.

use bevy::prelude::*;
use bevy_drape::{plugin::ClothBuilt, prelude::*};
use bevy_rapier3d::prelude::{Collider, Friction, PhysicsSet, RigidBody, Velocity};
use bevy_transform_interpolation::prelude::TransformInterpolation;
use examples_shared::figure::{Figure, FigurePlugin};
use examples_shared::physics::PhysicsPlugin;
use examples_shared::stage::{Grid, StagePlugin};
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};

use crate::{
    edges::edges_through,
    things::{self, Thing},
};

/// Length and width of the cloth (m).
const LENGTH: f32 = 1.55;
const WIDTH: f32 = 1.3;
/// Half of the size of the table's top, and how high its surface is (m).
const TOP: Vec3 = Vec3::new(0.6, 0.02, 0.4);
const HEIGHT: f32 = 0.72;
/// Radius of a particle (m): half of the place that the cloth takes.
const RADIUS: f32 = 0.002;
/// How high things stand on the cloth (m).
pub const SURFACE: f32 = HEIGHT + 2.1 * RADIUS;
/// How far the cloth hangs over the edge away from the hand (m): more would whip over the table as it is pulled.
const HEM: f32 = 0.06;
/// How fast the hand becomes (m/s), how soon (m/s²), and after which way it lets go (m).
const SPEED: f32 = 4.0;
const ACCELERATION: f32 = 25.0;
const WAY: f32 = 1.9;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    let stage = StagePlugin::lit_from(-2.6, 3.6, 2.4);
    app.add_plugins((stage, PhysicsPlugin, FigurePlugin, DrapePlugins::default()))
        .init_resource::<Pull>()
        .init_resource::<Shown>()
        .add_plugins(Keys(&[("T", "pull the cloth off")]))
        .add_systems(Startup, (spawn_table, spawn_cloth, things::spawn))
        .add_systems(
            FixedUpdate,
            (
                (lay_again, pull).chain().before(PhysicsSet::SyncBackend),
                count_edges.after(ClothSystems::WriteBack),
            ),
        )
        .add_systems(Update, (write_figure, press_key));
}

fn press_key(keys: Res<ButtonInput<KeyCode>>, mut pull: ResMut<Pull>) {
    if keys.just_pressed(KeyCode::KeyT) {
        pull.begin();
    }
}

/// How the cloth is pulled.
#[derive(Resource, Default, Clone, Copy, PartialEq)]
pub enum Pull {
    /// It lies.
    #[default]
    Not,
    /// It is taken hold of in the next tick.
    Begins,
    /// The hand has this speed (m/s) and has come this far (m).
    Goes(f32, f32),
    /// It is let go.
    Done,
}

impl Pull {
    /// If it lies.
    pub fn begin(&mut self) {
        if *self == Self::Not {
            *self = Self::Begins;
        }
    }
}

/// What pulls the cloth's right edge.
#[derive(Component)]
struct Hand;

/// The table's top.
#[derive(Component)]
struct Top;

fn spawn_table(mut shop: Workshop) {
    shop.commands
        .spawn((Name::new("floor"), ClothCollider::plane()));
    shop.commands.spawn((
        RigidBody::Fixed,
        Collider::cuboid(50.0, 0.5, 50.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    let wood = shop.rough(Color::srgb(0.36, 0.21, 0.11), 0.55);
    let size = 2.0 * TOP;
    let middle = Transform::from_xyz(0.0, HEIGHT - TOP.y, 0.0);
    let plate = shop.mesh(Cuboid::from_size(size));
    shop.commands.spawn((
        Name::new("table"),
        Top,
        (
            RigidBody::Fixed,
            Collider::cuboid(TOP.x, TOP.y, TOP.z),
            Friction::coefficient(0.5),
        ),
        ClothCollider::cuboid(size.x, size.y, size.z),
        plate,
        wood.clone(),
        middle,
    ));
    let leg = Vec3::new(0.05, HEIGHT - size.y, 0.05);
    let mesh = shop.mesh(Cuboid::from_size(leg));
    for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        shop.commands.spawn((
            ClothCollider::cuboid(leg.x, leg.y, leg.z),
            mesh.clone(),
            wood.clone(),
            Transform::from_xyz(x * (TOP.x - 0.08), 0.5 * leg.y, z * (TOP.z - 0.08)),
        ));
    }
    shop.commands.spawn((
        Name::new("hand"),
        Hand,
        TransformInterpolation,
        Transform::from_xyz(end(), HEIGHT, 0.0),
    ));
}

fn spawn_cloth(mut shop: Workshop) {
    // Linen with a red check.
    let linen = shop.fabric(Weave::Plain, 10, |_, yarn| {
        if yarn < 24 {
            Color::srgb(0.70, 0.10, 0.12)
        } else {
            Color::srgb(0.92, 0.90, 0.85)
        }
    });
    let columns = shop.grid.0;
    let spacing = LENGTH / (columns - 1) as f32;
    let rows = (WIDTH / spacing).round() as u32 + 1;
    shop.commands.spawn((
        Name::new("tablecloth"),
        Cloth::new(columns, rows, spacing).lying().centred(),
        Pins::none(),
        ClothMaterial {
            friction: 0.2,
            damping: 0.02,
            ..ClothMaterial::COTTON
        },
        ClothSettings {
            particle_radius: RADIUS,
            ..ClothSettings::substeps(24)
        },
        ClothSelfCollision::default(),
        linen,
        ShowClothGizmos::nothing(),
        Transform::from_xyz(end() - 0.5 * LENGTH, HEIGHT + RADIUS, 0.0),
    ));
}

/// Where the end that the hand takes lies at first, along the table (m).
fn end() -> f32 {
    LENGTH - TOP.x - HEM
}

/// Whether a place is on the table or above.
pub fn is_on_table(place: Vec3) -> bool {
    place.x.abs() < TOP.x && place.z.abs() < TOP.z && place.y > HEIGHT - TOP.y
}

/// A new cloth is laid below the things, which stand as at first.
fn lay_again(
    particles: Single<&ClothParticles>,
    mut things: Query<(&Thing, &mut Transform, &mut Velocity)>,
    mut pull: ResMut<Pull>,
) {
    if !particles.is_empty() {
        return;
    }
    *pull = Pull::Not;
    for (thing, mut transform, mut velocity) in &mut things {
        *transform = thing.0;
        *velocity = Velocity::default();
    }
}

/// The hand takes the right edge where it hangs, goes away with it, and lets go.
fn pull(
    cloth: Single<Entity, With<Cloth>>,
    hand: Single<&mut Transform, With<Hand>>,
    grid: Res<Grid>,
    time: Res<Time>,
    mut pull: ResMut<Pull>,
    mut commands: Commands,
) {
    let mut hand = hand.into_inner();
    match *pull {
        Pull::Not => {
            hand.translation.x = end();
            commands.entity(*cloth).remove::<ClothAttachments>();
        }
        Pull::Begins => {
            let edge = ClothAttachments::new([(Pin::Column(grid.0 - 1), "hand")]);
            commands.entity(*cloth).insert(edge);
            *pull = Pull::Goes(0.0, 0.0);
        }
        Pull::Goes(speed, way) => {
            let dt = time.delta_secs();
            let speed = (speed + ACCELERATION * dt).min(SPEED);
            let step = speed * dt;
            hand.translation.x += step;
            *pull = if way + step < WAY {
                Pull::Goes(speed, way + step)
            } else {
                commands.entity(*cloth).remove::<ClothAttachments>();
                Pull::Done
            };
        }
        Pull::Done => {}
    }
}

/// Triangles that an edge of the table passes through: now, and the most after any tick.
#[derive(Resource, Default)]
pub struct Shown {
    pub now: usize,
    pub most: usize,
}

fn count_edges(
    cloth: Single<(&ClothBuilt, &ClothParticles, &ClothFrame)>,
    top: Single<&Transform, With<Top>>,
    mut shown: ResMut<Shown>,
) {
    let (built, particles, frame) = *cloth;
    let to_table = top.to_isometry().inverse();
    let place = |position| to_table * frame.to_world(position);
    let places: Vec<Vec3> = particles.positions().map(place).collect();
    shown.now = edges_through(TOP, &places, built.surface().triangles());
    shown.most = shown.most.max(shown.now);
}

fn write_figure(
    shown: Res<Shown>,
    things: Query<(&Thing, &Transform)>,
    mut figure: ResMut<Figure>,
) {
    let away = |(thing, now): (&Thing, &Transform)| {
        let away = now.translation - thing.0.translation;
        away.with_y(0.0).length()
    };
    let farthest = things.iter().map(away).fold(0.0, f32::max);
    figure.is_good = shown.now == 0;
    figure.lines = vec![
        format!("triangles poked through: {}", shown.now),
        format!("dishes moved: {:.0} mm at most", 1.0e3 * farthest),
    ];
}
