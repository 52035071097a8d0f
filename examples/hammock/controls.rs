//! The window, and the ball's own keys.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_rapier3d::prelude::{ColliderMassProperties, Velocity};

use crate::{
    scene::{self, Ball, ScenePlugin},
    shared::{stage::Grid, window},
};

/// How fast the ball is tossed (m/s): some 0.8 m high.
const TOSS: f32 = 4.0;

/// Runs the scene in a window until it is closed.
pub fn run(grid: Grid) -> ExitCode {
    let more_keys = &[
        ("T", "toss the ball up"),
        ("Up, Down", "double, halve the ball's mass"),
    ];
    let mut app = window::app("a ball in a hammock", ScenePlugin, scene::SHOT, more_keys);
    app.insert_resource(grid)
        .add_systems(Update, press_ball_keys);
    window::run(app)
}

fn press_ball_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut balls: Query<(&mut Velocity, &mut ColliderMassProperties), With<Ball>>,
) {
    for (mut velocity, mut properties) in &mut balls {
        if keys.just_pressed(KeyCode::KeyT) {
            velocity.linear.y = TOSS;
        }
        for (key, factor) in [(KeyCode::ArrowUp, 2.0), (KeyCode::ArrowDown, 0.5)] {
            if keys.just_pressed(key)
                && let ColliderMassProperties::Mass(mass) = *properties
            {
                // From a beach ball to a cannon ball.
                *properties = ColliderMassProperties::Mass((mass * factor).clamp(0.05, 50.0));
            }
        }
    }
}
