//! Balloons on sticks: two round sheets each, sewn together along the edge and inflated.
//!
//! A closed mesh with a `ClothPressure` is a balloon. Its edge wrinkles as a real foil balloon's does: a flat sheet
//! can't become round without wrinkles. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example balloon                         # a window, or headless where no window opens
//! cargo run --example balloon -- --headless --out DIR # no window: prints a report, saves DIR/balloon.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | more, less gas |
//! | Right, Left | more, less wind |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloth |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

#[path = "../shared/measured.rs"]
mod measured;
mod models;
#[path = "../shared/plain.rs"]
mod plain;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    plain::Moment,
    scene::{Pump, ROOM, ScenePlugin},
    shared::{start::Example, window},
};

const TITLE: &str = "balloons";

fn main() -> ExitCode {
    Example {
        name: "balloon",
        about: "Balloons are inflated. Opens a window if possible, otherwise runs headless.",
        seconds: "6",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [
                ("Up, Down", "more, less gas"),
                ("Right, Left", "more, less wind"),
            ];
            let mut app = window::app(TITLE, ScenePlugin, scene::SHOT, &keys);
            app.insert_resource(grid).add_systems(Update, press_keys);
            window::run(app)
        },
        headless: |view, grid, options| {
            let moment = Moment {
                at: scene::DRAWN_AT,
                shot: scene::SHOT,
                file: "balloon.png",
            };
            plain::run((TITLE, ScenePlugin), &moment, view, grid, options)
        },
    }
    .run()
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut pump: ResMut<Pump>,
    mut wind: ResMut<ClothWind>,
) {
    for (key, change) in [(KeyCode::ArrowUp, 0.03), (KeyCode::ArrowDown, -0.03)] {
        if keys.just_pressed(key) {
            pump.0 = (pump.0 / ROOM + change).clamp(0.03, 1.2) * ROOM;
        }
    }
    for (key, factor) in [(KeyCode::ArrowRight, 1.25), (KeyCode::ArrowLeft, 0.8)] {
        if keys.just_pressed(key) {
            wind.velocity *= factor;
        }
    }
}
