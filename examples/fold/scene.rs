//! The cloth, the bar that lets it down, and the count of what passes through itself.

use bevy::prelude::*;
use bevy_drape::{contact::intersections, plugin::ClothBuilt, prelude::*};
use examples_shared::figure::{Figure, FigurePlugin};
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};

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

/// The scene, without a camera.
pub fn build(app: &mut App) {
    let stage = StagePlugin::lit_from(-2.0, 3.2, 2.6);
    app.add_plugins((stage, FigurePlugin, DrapePlugins::default()))
        .init_resource::<Crossings>()
        .add_plugins(Keys(&[("S", "self-collision on, off")]))
        .add_systems(Startup, (spawn_bar, spawn_cloth).chain())
        .add_systems(
            FixedUpdate,
            (
                sink.before(ClothSystems::Prepare),
                count_crossings.after(ClothSystems::WriteBack),
            ),
        )
        .add_systems(Update, press_key);
}

/// Without contact with itself the cloth passes through itself, and the figure says so.
fn press_key(
    keys: Res<ButtonInput<KeyCode>>,
    cloths: Query<(Entity, Has<ClothSelfCollision>), With<Cloth>>,
    mut commands: Commands,
) {
    if !keys.just_pressed(KeyCode::KeyS) {
        return;
    }
    for (cloth, touches_itself) in &cloths {
        if touches_itself {
            commands.entity(cloth).remove::<ClothSelfCollision>();
        } else {
            commands.entity(cloth).insert(contact());
        }
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
struct Bar;

fn spawn_bar(mut shop: Workshop) {
    shop.commands
        .spawn((Name::new("floor"), ClothCollider::plane()));
    let wood = shop.rough(Color::srgb(0.42, 0.27, 0.15), 0.7);
    let along = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    let stick = shop.mesh(Cylinder::new(0.012, WIDTH + 0.16));
    let above = Transform::from_xyz(0.0, 0.012, 0.0).with_rotation(along);
    shop.commands.spawn((
        Name::new("bar"),
        Bar,
        Transform::from_xyz(0.0, TOP, 0.0),
        Visibility::default(),
        children![(stick, wood, above)],
    ));
}

fn spawn_cloth(mut shop: Workshop) {
    // Broad stripes across: each fold shows another.
    let stripes = shop.fabric(Weave::WeftTwill, 5, |runs_down, yarn| {
        match (runs_down, yarn / 16) {
            (true, _) | (false, 1) => Color::srgb(0.86, 0.84, 0.78),
            (false, 0 | 2) => Color::srgb(0.13, 0.36, 0.52),
            (false, _) => Color::srgb(0.80, 0.42, 0.20),
        }
    });
    let columns = shop.grid.0;
    let spacing = WIDTH / (columns - 1) as f32;
    let rows = (3 * columns / 2).max(2);
    shop.commands.spawn((
        Name::new("cloth"),
        Cloth::new(columns, rows, spacing).centred(),
        Pins::none(),
        held(),
        contact(),
        ClothSettings {
            particle_radius: 0.003,
            ..default()
        },
        stripes,
        ShowClothGizmos::nothing(),
        Transform::from_xyz(0.0, TOP - 0.5 * (rows - 1) as f32 * spacing, 0.0),
    ));
}

/// Of the cloth with itself.
fn contact() -> ClothSelfCollision {
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
