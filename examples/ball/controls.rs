//! The window, and the ball's own keys.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::plugin::ClothColliderSpeed;

use crate::{
    scene::{self, ScenePlugin},
    shared::{stage::Grid, window},
};

/// Runs the scene in a window until it is closed.
pub fn run(grid: Grid) -> ExitCode {
    let more_keys = &[("Up, Down", "faster, slower ball")];
    let mut app = window::app(
        "a ball and a cloth (debug view)",
        ScenePlugin,
        scene::SHOT,
        more_keys,
    );
    app.insert_resource(grid)
        .add_systems(Update, press_ball_keys);
    window::run(app)
}

fn press_ball_keys(keys: Res<ButtonInput<KeyCode>>, mut speeds: Query<&mut ClothColliderSpeed>) {
    let pressed = |key| if keys.just_pressed(key) { 0.25 } else { 0.0 };
    let change = pressed(KeyCode::ArrowUp) - pressed(KeyCode::ArrowDown);
    if change != 0.0 {
        for mut speed in &mut speeds {
            speed.0 = (speed.0 + change).clamp(0.0, 10.0);
        }
    }
}
