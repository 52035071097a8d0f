//! Three balloons on sticks.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use examples_shared::arrows::{right_left, up_down};
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};

use crate::models::discs;

/// Radius of the discs that a balloon is made of (m).
const RADIUS: f32 = 0.28;
/// What goes into one (m³): 1.2185 radius³, W. H. Paulsen 1994.
const ROOM: f32 = 1.2185 * RADIUS * RADIUS * RADIUS;
/// Gas that they are blown up with at first (m³), and how fast (m³/s). The air around them presses by `OUTSIDE` Pa: less than that of the
/// sea, so that it is felt how they get harder.
const GAS: f32 = 1.06 * ROOM;
const BLOWING: f32 = 0.4 * ROOM;
const OUTSIDE: f32 = 500.0;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(-2.5, 4.5, 3.5),
        DrapePlugins::default(),
    ))
    .insert_resource(ClothWind::gusty(Vec3::new(0.5, 0.0, -0.2)))
    .insert_resource(Pump(GAS))
    .add_plugins(Keys(&[
        ("Up, Down", "more, less gas"),
        ("Right, Left", "more, less wind"),
    ]))
    .add_systems(Startup, spawn_balloons)
    .add_systems(FixedUpdate, blow_up.before(ClothSystems::Prepare))
    .add_systems(Update, press_keys);
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut pump: ResMut<Pump>,
    mut wind: ResMut<ClothWind>,
) {
    let more = 0.03 * up_down(&keys);
    if more != 0.0 {
        pump.0 = (pump.0 / ROOM + more).clamp(0.03, 1.2) * ROOM;
    }
    wind.velocity *= 1.25_f32.powf(right_left(&keys));
}

/// The gas that all are brought to (m³).
#[derive(Resource)]
struct Pump(f32);

fn gas(volume: f32) -> ClothPressure {
    ClothPressure::Gas {
        volume,
        outside: OUTSIDE,
    }
}

/// Slowly: what is blown up at a stroke bursts.
fn blow_up(mut balloons: Query<&mut ClothPressure>, pump: Res<Pump>, time: Res<Time>) {
    let step = BLOWING * time.delta_secs();
    for mut pressure in &mut balloons {
        if let ClothPressure::Gas { volume, .. } = *pressure
            && volume != pump.0
        {
            *pressure = gas(volume + (pump.0 - volume).clamp(-step, step));
        }
    }
}

fn spawn_balloons(mut shop: Workshop) {
    let rings = shop.grid.0.max(3);
    let balloon = shop.mesh(discs(RADIUS, rings));
    let white = shop.paint(Color::srgb(0.92, 0.92, 0.90));
    for (name, color, place, turn) in [
        (
            "red",
            Color::srgb(0.82, 0.05, 0.12),
            Vec3::new(-0.52, 0.98, 0.0),
            0.35,
        ),
        (
            "gold",
            Color::srgb(0.95, 0.66, 0.10),
            Vec3::new(0.02, 1.22, -0.25),
            0.0,
        ),
        (
            "teal",
            Color::srgb(0.02, 0.48, 0.52),
            Vec3::new(0.54, 0.92, 0.05),
            -0.3,
        ),
    ] {
        let height = place.y - RADIUS;
        let stick = shop.mesh(Cylinder::new(0.008, height));
        let middle = Transform::from_translation(place.with_y(0.5 * height));
        shop.commands.spawn((stick, white.clone(), middle));
        // Silk with a thread of light now and then, and as shiny.
        let silk = shop.weave(Weave::Plain, 2, |_, yarn| match yarn % 16 {
            0 => color.mix(&Color::WHITE, 0.5),
            _ => color,
        });
        let silk = shop.paint(StandardMaterial {
            metallic: 0.3,
            perceptual_roughness: 0.35,
            reflectance: 0.6,
            ..silk
        });
        let tip = Pin::Near {
            point: Vec3::NEG_Y * RADIUS,
            radius: 0.018,
        };
        shop.commands.spawn((
            Name::new(name),
            Cloth::mesh(),
            balloon.clone(),
            Pins::new([tip]),
            gas(0.02 * ROOM),
            ClothMaterial {
                areal_density: 0.06,
                damping: 0.03,
                ..ClothMaterial::SILK
            },
            ClothSettings {
                // Filled with what is lighter than air.
                gravity: Some(Vec3::Y),
                ..ClothSettings::substeps(48)
            },
            ShowClothGizmos::nothing(),
            silk,
            Transform::from_translation(place).with_rotation(Quat::from_rotation_y(turn)),
        ));
    }
}
