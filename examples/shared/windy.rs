//! Keys that change the wind of the world.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::arrows::{right_left, up_down};
use crate::window::Keys;

/// From one press to the next (m/s, rad).
const STRONGER: f32 = 2.0;
const TURN: f32 = 0.3;

/// Listens to the keys.
pub struct KeysPlugin;

impl Plugin for KeysPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(Keys(&[
            ("Up, Down", "stronger, weaker wind"),
            ("Left, Right", "turn the wind"),
            ("T", "turbulence on, off"),
        ]))
        .add_systems(Update, press_keys);
    }
}

/// Changes the resource; `unsteady` are its gusts and turbulence while they are off.
fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut wind: ResMut<ClothWind>,
    mut unsteady: Local<Option<(f32, f32)>>,
) {
    let stronger = STRONGER * up_down(&keys);
    let turn = -TURN * right_left(&keys);
    if stronger != 0.0 || turn != 0.0 {
        let speed = wind.velocity.length();
        let direction = wind.velocity.try_normalize().unwrap_or(Vec3::X);
        // Never quite none: it keeps its direction.
        let speed = (speed + stronger).clamp(0.01, 40.0);
        wind.velocity = Quat::from_rotation_y(turn) * direction * speed;
    }
    if keys.just_pressed(KeyCode::KeyT) {
        (wind.gusts, wind.turbulence) = match unsteady.take() {
            Some(values) => values,
            None => {
                *unsteady = Some((wind.gusts, wind.turbulence));
                (0.0, 0.0)
            }
        };
    }
}
