//! A figure, and the two panels of a tunic that are sewn around it.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Paint, Weave, Workshop};

/// Width of a panel, and its height (m).
const WIDTH: f32 = 0.62;
const HEIGHT: f32 = 0.84;
/// Height of the shoulder seam, and how far in front of the figure's middle and behind it the panels begin (m).
const TOP: f32 = 1.53;
const AWAY: f32 = 0.24;
/// How long the seams take to close, and when gravity begins (s).
const CLOSING: f32 = 2.0;
const DRESSED: f32 = 2.25;
/// When the figure begins to turn (s), how far to either side (rad), and how long from side to side and back (s).
const TURNS: f32 = 4.0;
const TURN: f32 = 0.7;
const PERIOD: f32 = 4.0;
/// Parts of a panel's upper edge that are a shoulder, on each side, and of its height that are left open for the arm.
const SHOULDER: f32 = 0.3;
const ARMHOLE: f32 = 0.36;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(3.0, 5.0, 4.0),
        DrapePlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    .add_plugins(Keys(&[("U", "undo the side seams, sew them again")]))
    .insert_resource(ClothGravity(Vec3::ZERO))
    .add_systems(Startup, (spawn_figure, lay_out))
    .add_systems(FixedUpdate, (let_fall, turn).before(ClothSystems::Prepare))
    .add_systems(Update, undo);
}

/// The figure, which turns.
#[derive(Component)]
struct Figure;

/// A seam that can be undone.
#[derive(Component)]
struct Sides;

/// Lays out both panels, and sews them together.
fn lay_out(mut shop: Workshop) {
    let columns = shop.grid.0.max(8);
    let spacing = WIDTH / (columns - 1) as f32;
    let rows = (HEIGHT / spacing).round() as u32 + 1;
    let fabrics = [front(&mut shop), back(&mut shop)];
    let panels = [("front", AWAY), ("back", -AWAY)];
    let [front, back] = [0, 1].map(|of| {
        let ((name, away), fabric) = (panels[of], fabrics[of].clone());
        let panel = (
            Name::new(name),
            Cloth::new(columns, rows, spacing),
            Pins::none(),
            ClothMaterial::COTTON,
            ClothSelfCollision::of_thickness(0.006),
            fabric,
            ShowClothGizmos::nothing(),
            Transform::from_xyz(-WIDTH / 2.0, TOP, away),
        );
        shop.commands.spawn(panel).id()
    });
    let shoulder = (SHOULDER * columns as f32) as u32;
    let shoulders = Pin::filter(move |row, column| {
        row == 0 && (column < shoulder || column >= columns - shoulder)
    });
    let below_arm = (ARMHOLE * rows as f32) as u32;
    let sides =
        Pin::filter(move |row, column| row >= below_arm && (column == 0 || column == columns - 1));
    let sew = |pin: Pin| ClothSeam::new((front, pin.clone()), (back, pin)).closing_in(CLOSING);
    shop.commands
        .spawn((Name::new("shoulders"), sew(shoulders)));
    shop.commands.spawn((Name::new("sides"), Sides, sew(sides)));
}

fn let_fall(time: Res<Time>, mut gravity: ResMut<ClothGravity>) {
    if time.elapsed_secs() >= DRESSED {
        gravity.0 = Vec3::new(0.0, -9.81, 0.0);
    }
}

fn turn(time: Res<Time>, mut figures: Query<&mut Transform, With<Figure>>) {
    let since = (time.elapsed_secs() - TURNS).max(0.0);
    for mut figure in &mut figures {
        figure.rotation = Quat::from_rotation_y(TURN * (since * TAU / PERIOD).sin());
    }
}

fn undo(keys: Res<ButtonInput<KeyCode>>, mut seams: Query<&mut ClothSeam, With<Sides>>) {
    if keys.just_pressed(KeyCode::KeyU) {
        for mut seam in &mut seams {
            seam.sewn[1] = 1.0 - seam.sewn[1];
        }
    }
}

/// Torso, neck, head, shoulders, arms and legs.
fn spawn_figure(mut shop: Workshop) {
    shop.commands
        .spawn((Name::new("floor"), ClothCollider::plane()));
    let skin = shop.rough(Color::srgb(0.80, 0.76, 0.70), 0.7);
    let figure = (Name::new("figure"), Figure, TransformInterpolation);
    let figure = (figure, Transform::default(), Visibility::default());
    let figure = shop.commands.spawn(figure).id();
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    let arm = |side: f32| {
        let lean = Quat::from_rotation_z(side * 0.9);
        let shoulder = Vec3::new(side * 0.19, 1.42, 0.0);
        let down = lean * Vec3::NEG_Y;
        Transform::from_translation(shoulder + 0.22 * down).with_rotation(lean)
    };
    let leg = |side: f32| Transform::from_xyz(side * 0.09, 0.45, 0.0);
    // Radius and length, and where.
    let limbs = [
        (0.125, 0.26, Transform::from_xyz(0.0, 1.20, 0.0)),
        (
            0.14,
            0.06,
            Transform::from_xyz(0.0, 0.93, 0.0).with_rotation(lying),
        ),
        (
            0.06,
            0.32,
            Transform::from_xyz(0.0, 1.43, 0.0).with_rotation(lying),
        ),
        (0.05, 0.12, Transform::from_xyz(0.0, 1.52, 0.0)),
        (0.10, 0.06, Transform::from_xyz(0.0, 1.68, 0.0)),
        (0.045, 0.44, arm(1.0)),
        (0.045, 0.44, arm(-1.0)),
        (0.07, 0.72, leg(1.0)),
        (0.07, 0.72, leg(-1.0)),
    ];
    for (radius, length, place) in limbs {
        let mesh = shop.mesh(Capsule3d::new(radius, length));
        let collider = ClothCollider::capsule(radius, length);
        let limb = (mesh, skin.clone(), collider, place, ChildOf(figure));
        shop.commands.spawn(limb);
    }
}

fn front(shop: &mut Workshop) -> Paint {
    shop.fabric(Weave::Twill, 2, |_, yarn| match yarn / 8 % 3 {
        0 => Color::srgb(0.90, 0.86, 0.76),
        _ => Color::srgb(0.20, 0.36, 0.55),
    })
}

fn back(shop: &mut Workshop) -> Paint {
    shop.fabric(Weave::Twill, 2, |_, _| Color::srgb(0.72, 0.28, 0.22))
}
