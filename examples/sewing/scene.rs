//! A figure, and the six panels of a shirt that are sewn around it: front, back, and two for each sleeve.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Paint, Weave, Workshop};

/// Width of the front and the back, and their height (m).
const WIDTH: f32 = 0.62;
const HEIGHT: f32 = 0.84;
/// Length of a sleeve (m).
const SLEEVE: f32 = 0.27;
/// Height of the shoulder seam, and how far in front of the figure's middle and behind it the panels begin (m).
const TOP: f32 = 1.53;
const AWAY: f32 = 0.22;
/// How long the seams take to close, and when gravity begins (s).
const CLOSING: f32 = 2.0;
const DRESSED: f32 = 2.25;
/// When the figure begins to walk (s), how fast (m/s), around a circle of which radius (m), and how long two steps take (s).
const WALKS: f32 = 4.0;
const SPEED: f32 = 0.7;
const AROUND: f32 = 0.6;
const STRIDE: f32 = 1.1;
/// How far legs and arms swing to either side (rad).
const LEGS: f32 = 0.35;
const ARMS: f32 = 0.15;
/// How far the arms are held off the body (rad), and where they begin (m).
const LEAN: f32 = 1.2;
const ARM: Vec3 = Vec3::new(0.19, 1.42, 0.0);
/// Parts of a panel's upper edge that are a shoulder, on each side, and of its height that are open for the arm.
const SHOULDER: f32 = 0.3;
const ARMHOLE: f32 = 0.38;

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
    .add_systems(FixedUpdate, (let_fall, walk).before(ClothSystems::Prepare))
    .add_systems(Update, undo);
}

/// The figure, which walks.
#[derive(Component)]
struct Figure;

/// An arm or a leg, which swings about its upper end by so much (rad).
#[derive(Component)]
struct Limb {
    rest: Transform,
    about: Vec3,
    by: f32,
}

/// A seam that can be undone.
#[derive(Component)]
struct Sides;

/// The panels before the figure and behind it: their names' ends, and their distance from its middle (m).
const LAYERS: [(&str, f32); 2] = [("front", AWAY), ("back", -AWAY)];

/// Lays out all panels, and sews them together.
fn lay_out(mut shop: Workshop) {
    let columns = shop.grid.0.max(8);
    let spacing = WIDTH / (columns - 1) as f32;
    let count = |length: f32| (length / spacing).round() as u32 + 1;
    let (rows, across, along) = (count(HEIGHT), count(ARMHOLE * HEIGHT), count(SLEEVE));
    let fabrics = [front(&mut shop), back(&mut shop)];
    let body = [0, 1].map(|layer| {
        let (name, away) = LAYERS[layer];
        let place = Transform::from_xyz(-WIDTH / 2.0, TOP, away);
        let cloth = (columns, rows, spacing);
        spawn_panel(&mut shop, name.into(), cloth, place, fabrics[layer].clone())
    });
    let shoulder = (SHOULDER * columns as f32) as u32;
    let shoulders = Pin::filter(move |row, column| {
        row == 0 && (column < shoulder || column >= columns - shoulder)
    });
    let sides =
        Pin::filter(move |row, column| row + 1 >= across && (column == 0 || column == columns - 1));
    sew(
        &mut shop,
        "shoulders",
        [(body[0], shoulders.clone()), (body[1], shoulders)],
    );
    let sides = sew(
        &mut shop,
        "sides",
        [(body[0], sides.clone()), (body[1], sides)],
    );
    shop.commands.entity(sides).insert(Sides);
    for side in [-1.0_f32, 1.0] {
        // Columns run to the right: from the hand to the shoulder on the left, where the figure's right arm is.
        let (edge, inner, name) = match side < 0.0 {
            true => (0, along - 1, "right sleeve"),
            false => (columns - 1, 0, "left sleeve"),
        };
        let sleeve = [0, 1].map(|layer| {
            let (of, away) = LAYERS[layer];
            let place = sleeve_place(side, spacing * (across - 1) as f32, away);
            let cloth = (along, across, spacing);
            let fabric = fabrics[layer].clone();
            spawn_panel(&mut shop, format!("{name}, {of}"), cloth, place, fabric)
        });
        for row in [0, across - 1] {
            sew(&mut shop, name, sleeve.map(|panel| (panel, Pin::Row(row))));
        }
        for (panel, sleeve) in body.into_iter().zip(sleeve) {
            let armhole = Pin::filter(move |row, column| row < across && column == edge);
            sew(
                &mut shop,
                "armhole",
                [(panel, armhole), (sleeve, Pin::Column(inner))],
            );
        }
    }
}

/// Where a panel of a sleeve begins that is so wide (m), on the left (−1) or on the right: along the arm.
fn sleeve_place(side: f32, width: f32, away: f32) -> Transform {
    let turn = Quat::from_rotation_z(side * (LEAN - FRAC_PI_2));
    let (along, up) = (turn * Vec3::X, turn * Vec3::Y);
    let shoulder = Vec3::new(side * ARM.x, ARM.y, away);
    // It begins beside the edge of the front or the back, or ends there.
    let beside = (WIDTH / 2.0 - ARM.x) / along.x + 0.02;
    let from = if side < 0.0 { -beside - SLEEVE } else { beside };
    Transform::from_translation(shoulder + from * along + width / 2.0 * up).with_rotation(turn)
}

fn spawn_panel(
    shop: &mut Workshop,
    name: String,
    (columns, rows, spacing): (u32, u32, f32),
    place: Transform,
    fabric: Paint,
) -> Entity {
    let panel = (
        Name::new(name),
        Cloth::new(columns, rows, spacing),
        Pins::none(),
        ClothMaterial::COTTON,
        seam_allowance(columns, rows),
        ClothSelfCollision::of_thickness(0.006),
        fabric,
        ShowClothGizmos::nothing(),
        place,
    );
    shop.commands.spawn(panel).id()
}

/// Edges are folded over twice where they are sewn or hemmed: three layers, and three times the mass.
fn seam_allowance(columns: u32, rows: u32) -> ClothMaterialMap {
    let is_edge = |row, column| row == 0 || row + 1 == rows || column == 0 || column + 1 == columns;
    let added = (0..rows).flat_map(|row| {
        (0..columns).map(move |column| if is_edge(row, column) { 2.0 } else { 0.0 })
    });
    ClothMaterialMap {
        density: ClothFactor::added(ClothPaint::Vertices(added.collect())),
        ..default()
    }
}

fn sew(shop: &mut Workshop, name: &'static str, [first, second]: [(Entity, Pin); 2]) -> Entity {
    let seam = ClothSeam::new(first, second).closing_in(CLOSING);
    shop.commands.spawn((Name::new(name), seam)).id()
}

fn let_fall(time: Res<Time>, mut gravity: ResMut<ClothGravity>) {
    if time.elapsed_secs() >= DRESSED {
        gravity.0 = Vec3::new(0.0, -9.81, 0.0);
    }
}

fn walk(
    time: Res<Time>,
    mut figures: Query<&mut Transform, With<Figure>>,
    mut limbs: Query<(&Limb, &mut Transform), Without<Figure>>,
) {
    let since = (time.elapsed_secs() - WALKS).max(0.0);
    let turned = since * SPEED / AROUND;
    let swing = (since * TAU / STRIDE).sin() * since.min(1.0);
    for mut figure in &mut figures {
        let turn = Quat::from_rotation_y(turned);
        figure.translation = turn * Vec3::NEG_X * AROUND + Vec3::X * AROUND;
        figure.rotation = turn;
    }
    for (limb, mut place) in &mut limbs {
        *place = limb.rest;
        place.rotate_around(limb.about, Quat::from_rotation_x(limb.by * swing));
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
    let at = |side: f32, place: Vec3| Vec3::new(side * place.x, place.y, 0.0);
    let arm = |side: f32| {
        let lean = Quat::from_rotation_z(side * LEAN);
        let down = lean * Vec3::NEG_Y;
        let rest = Transform::from_translation(at(side, ARM) + 0.22 * down).with_rotation(lean);
        let (about, by) = (at(side, ARM), side * ARMS);
        (0.045, 0.44, Limb { rest, about, by })
    };
    let leg = |side: f32| {
        let rest = Transform::from_translation(at(side, Vec3::new(0.09, 0.45, 0.0)));
        let (about, by) = (at(side, Vec3::new(0.09, 0.81, 0.0)), -side * LEGS);
        (0.07, 0.72, Limb { rest, about, by })
    };
    // Radius and length (m), and where.
    let trunk = [
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
    ];
    let trunk = trunk.map(|(radius, length, rest)| {
        let (about, by) = (rest.translation, 0.0);
        (radius, length, Limb { rest, about, by })
    });
    let limbs = [arm(1.0), arm(-1.0), leg(1.0), leg(-1.0)];
    for (radius, length, limb) in trunk.into_iter().chain(limbs) {
        let mesh = shop.mesh(Capsule3d::new(radius, length));
        let collider = ClothCollider::capsule(radius, length);
        let limb = (
            mesh,
            skin.clone(),
            collider,
            limb.rest,
            limb,
            ChildOf(figure),
        );
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
