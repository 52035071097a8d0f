//! Keys that change the wind of the world.

use bevy::prelude::*;
use bevy_drape::prelude::*;

/// From one press to the next (m/s, rad).
const STRONGER: f32 = 2.0;
const TURN: f32 = 0.3;

/// What the panel says of them.
pub const KEYS: [(&str, &str); 3] = [
    ("Up, Down", "stronger, weaker wind"),
    ("Left, Right", "turn the wind"),
    ("T", "turbulence on, off"),
];

/// Changes the resource; `unsteady` are its gusts and turbulence while they are off.
pub fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut wind: ResMut<ClothWind>,
    mut unsteady: Local<Option<(f32, f32)>>,
) {
    let pressed = |key| f32::from(u8::from(keys.just_pressed(key)));
    let stronger = STRONGER * (pressed(KeyCode::ArrowUp) - pressed(KeyCode::ArrowDown));
    let turn = TURN * (pressed(KeyCode::ArrowLeft) - pressed(KeyCode::ArrowRight));
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
