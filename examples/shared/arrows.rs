//! Arrow keys that make something more or less.

use bevy::prelude::*;

/// 1 if the upper arrow was pressed in this frame, −1 if the lower one was.
pub fn up_down(keys: &ButtonInput<KeyCode>) -> f32 {
    step(keys, KeyCode::ArrowUp, KeyCode::ArrowDown)
}

/// 1 if the right arrow was pressed in this frame, −1 if the left one was.
pub fn right_left(keys: &ButtonInput<KeyCode>) -> f32 {
    step(keys, KeyCode::ArrowRight, KeyCode::ArrowLeft)
}

fn step(keys: &ButtonInput<KeyCode>, more: KeyCode, less: KeyCode) -> f32 {
    let pressed = |key| f32::from(u8::from(keys.just_pressed(key)));
    pressed(more) - pressed(less)
}
