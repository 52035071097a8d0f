//! Posts, a line, a sheet and two towels, and the pegs that hold them.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Paint, Weave, Workshop};

/// Height of the line, and distance between the posts (m).
const LINE: f32 = 1.9;
const POSTS: f32 = 3.6;
/// How fast a peg falls (m/s²).
const GRAVITY: f32 = 9.81;
/// How long the laundry takes to dry (s).
const DRYING: f32 = 60.0;

/// A piece of laundry.
struct Piece {
    name: &'static str,
    /// Where its left edge is along the line (m).
    left: f32,
    /// Width and height (m).
    size: Vec2,
    /// kg/m².
    density: f32,
    /// Water over dry weight at its lower edge, as it is hung up; none at its upper edge.
    water: f32,
    /// Number of pegs that hold it.
    pegs: u32,
}

const PIECES: [Piece; 3] = [
    Piece {
        name: "sheet",
        left: -0.5,
        size: Vec2::new(1.4, 1.2),
        density: 0.14,
        water: 0.5,
        pegs: 3,
    },
    Piece {
        name: "bath towel",
        left: -1.4,
        size: Vec2::new(0.7, 1.1),
        density: 0.45,
        water: 1.5,
        pegs: 2,
    },
    Piece {
        name: "hand towel",
        left: 1.05,
        size: Vec2::new(0.45, 0.6),
        density: 0.3,
        water: 1.5,
        pegs: 2,
    },
];

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(3.0, 5.0, 4.0),
        DrapePlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    .add_plugins(Keys(&[
        ("Click on peg", "take it off"),
        ("H", "hang everything up again"),
    ]))
    // A light breeze, from behind and from the left.
    .insert_resource(ClothWind::gusty(Vec3::new(0.4, 0.0, 1.1)))
    .add_observer(press_peg)
    .add_observer(show_hand)
    .add_systems(Startup, (spawn_line, hang_up))
    .add_systems(FixedUpdate, (drop_pegs, dry.before(ClothSystems::Prepare)))
    .add_systems(
        Update,
        (take_down, hang_up).chain().run_if(is_asked_to_hang),
    );
}

/// Cloths and pegs on the line.
#[derive(Component)]
struct Laundry;

/// Water that a cloth holds at its lower edge, over its dry weight, and its height (m).
#[derive(Component)]
struct Wet {
    water: f32,
    height: f32,
}

/// Water goes, and with it weight, from the lower edge up.
fn dry(
    mut laundry: Query<(Entity, &mut Wet, &mut ClothMaterialMap)>,
    time: Res<Time>,
    mut commands: Commands,
) {
    for (cloth, mut wet, mut map) in &mut laundry {
        wet.water -= time.delta_secs() / DRYING;
        if wet.water <= 0.0 {
            commands.entity(cloth).remove::<(Wet, ClothMaterialMap)>();
            continue;
        }
        // More below, where the water runs.
        let Wet { water, height } = *wet;
        let below = ClothPaint::at_rest(move |place| water * (-place.y / height).max(0.0));
        map.density = ClothFactor::added(below);
    }
}

/// A peg, and the cloth that it holds.
#[derive(Component)]
pub struct Peg {
    pub cloth: Entity,
}

/// A peg that falls, and its speed (m/s).
#[derive(Component, Default)]
struct Dropped(f32);

fn is_asked_to_hang(keys: Res<ButtonInput<KeyCode>>) -> bool {
    keys.just_pressed(KeyCode::KeyH)
}

fn take_down(hung: Query<Entity, With<Laundry>>, mut commands: Commands) {
    hung.iter()
        .for_each(|entity| commands.entity(entity).despawn());
}

/// Hangs everything on the line.
fn hang_up(mut shop: Workshop) {
    let fabrics = [
        sheet(&mut shop),
        bath_towel(&mut shop),
        hand_towel(&mut shop),
    ];
    let wood = shop.rough(Color::srgb(0.72, 0.50, 0.28), 0.6);
    let half = shop.mesh(Cuboid::new(0.02, 0.09, 0.009));
    for (piece, fabric) in PIECES.iter().zip(fabrics) {
        let spacing = PIECES[0].size.x / (shop.grid.0.max(8) - 1) as f32;
        let [columns, rows] = piece
            .size
            .to_array()
            .map(|side| (side / spacing).round() as u32 + 1);
        let corner = Vec3::new(piece.left, LINE, 0.0);
        let cloth = shop.commands.spawn_empty().id();
        let mut held = ClothAttachments::default();
        for number in 0..piece.pegs {
            // Three particles each, from one corner to the other.
            let first = number * (columns - 3) / (piece.pegs - 1);
            let place = corner + Vec3::X * spacing * (first + 1) as f32;
            let peg = shop.commands.spawn((
                Laundry,
                Peg { cloth },
                TransformInterpolation,
                Transform::from_translation(place),
                Visibility::default(),
            ));
            let halves = [-1.0_f32, 1.0].map(|side| {
                let lean = Quat::from_rotation_x(0.12 * side);
                let place = Transform::from_xyz(0.0, 0.012, 0.007 * side).with_rotation(lean);
                (half.clone(), wood.clone(), place)
            });
            let peg = peg_with(peg, halves);
            for column in first..first + 3 {
                held.attach(Pin::Cell(0, column), peg);
            }
        }
        shop.commands.entity(cloth).insert((
            Name::new(piece.name),
            Laundry,
            Cloth::new(columns, rows, spacing),
            Pins::none(),
            held,
            ClothMaterial {
                areal_density: piece.density,
                ..ClothMaterial::COTTON
            },
            ClothSelfCollision::default(),
            ClothMaterialMap::default(),
            Wet {
                water: piece.water,
                height: piece.size.y,
            },
            fabric,
            ShowClothGizmos::nothing(),
            Transform::from_translation(corner),
        ));
    }
}

fn peg_with(mut peg: EntityCommands, halves: [(Mesh3d, Paint, Transform); 2]) -> Entity {
    halves.into_iter().for_each(|half| {
        peg.with_child(half);
    });
    peg.id()
}

/// Takes a peg off, which lets its cloth go, and drops it.
pub fn take_off(
    peg: Entity,
    pegs: &Query<&Peg>,
    cloths: &mut Query<&mut ClothAttachments>,
    commands: &mut Commands,
) {
    let Ok(Peg { cloth }) = pegs.get(peg) else {
        return;
    };
    if let Ok(mut held) = cloths.get_mut(*cloth) {
        held.detach(peg);
    }
    commands
        .entity(peg)
        .remove::<Peg>()
        .insert(Dropped::default());
}

/// The press is on one of the halves, and goes on to the peg.
fn press_peg(
    press: On<Pointer<Press>>,
    pegs: Query<&Peg>,
    mut cloths: Query<&mut ClothAttachments>,
    mut commands: Commands,
) {
    take_off(press.entity, &pegs, &mut cloths, &mut commands);
}

/// A hand is a small ball.
fn show_hand(added: On<Add, ClothGrab>, mut shop: Workshop) {
    let ball = shop.mesh(Sphere::new(0.028).mesh().uv(32, 16));
    let skin = shop.rough(Color::srgb(0.86, 0.62, 0.50), 0.7);
    shop.commands.entity(added.entity).insert((
        ball,
        skin,
        TransformInterpolation,
        Pickable::IGNORE,
    ));
}

fn drop_pegs(mut pegs: Query<(&mut Dropped, &mut Transform)>, time: Res<Time>) {
    for (mut dropped, mut place) in &mut pegs {
        // It lies on the floor at last.
        if place.translation.y > 0.006 {
            dropped.0 += GRAVITY * time.delta_secs();
            place.translation.y = (place.translation.y - dropped.0 * time.delta_secs()).max(0.006);
            place.rotation = Quat::from_rotation_x(FRAC_PI_2 * (1.0 - place.translation.y / LINE));
        }
    }
}

fn spawn_line(mut shop: Workshop) {
    shop.commands
        .spawn((Name::new("floor"), ClothCollider::plane()));
    let wood = shop.rough(Color::srgb(0.42, 0.30, 0.20), 0.7);
    let white = shop.rough(Color::srgb(0.92, 0.91, 0.88), 0.8);
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    let line = Transform::from_xyz(0.0, LINE + 0.008, 0.0).with_rotation(lying);
    let line = (shop.mesh(Cylinder::new(0.005, POSTS)), white, line);
    shop.commands.spawn(line);
    let height = LINE + 0.15;
    let post = shop.mesh(Cylinder::new(0.035, height));
    let arm = shop.mesh(Cylinder::new(0.02, 0.5));
    for side in [-0.5, 0.5] {
        let place = Transform::from_xyz(side * POSTS, 0.5 * height, 0.0);
        shop.commands.spawn((post.clone(), wood.clone(), place));
        let across = Quat::from_rotation_x(FRAC_PI_2);
        let place = Transform::from_xyz(side * POSTS, LINE, 0.0).with_rotation(across);
        shop.commands.spawn((arm.clone(), wood.clone(), place));
    }
}

/// White, with a blue border.
fn sheet(shop: &mut Workshop) -> Paint {
    shop.fabric(Weave::Plain, 6, |_, yarn| match yarn % 32 {
        0..2 => Color::srgb(0.35, 0.52, 0.75),
        _ => Color::srgb(0.93, 0.94, 0.95),
    })
}

/// Broad stripes.
fn bath_towel(shop: &mut Workshop) -> Paint {
    shop.fabric(Weave::Twill, 2, |runs_down, yarn| {
        match (runs_down, yarn / 8 % 4) {
            (false, 0) => Color::srgb(0.95, 0.88, 0.70),
            _ => Color::srgb(0.85, 0.38, 0.24),
        }
    })
}

fn hand_towel(shop: &mut Workshop) -> Paint {
    shop.fabric(Weave::Herringbone, 2, |runs_down, yarn| {
        match (runs_down, yarn / 16 % 2) {
            (true, 0) => Color::srgb(0.15, 0.45, 0.42),
            _ => Color::srgb(0.55, 0.75, 0.62),
        }
    })
}
