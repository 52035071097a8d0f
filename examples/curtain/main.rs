//! A curtain in two halves on rings, and a walker who pushes through it.
//!
//! Each ring is an entity on the rail, and `ClothAttachments` tie a half's top row to its rings. Rings that move
//! together gather the cloth into pleats. The walker is an entity with colliders as children. The scene is in
//! `scene.rs`.
//!
//! ```sh
//! cargo run --example curtain                         # a window, or headless where no window opens
//! cargo run --example curtain -- --headless --out DIR # no window: prints a report, saves DIR/curtain.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | O | open, close the curtain |
//! | Up, Down | faster, slower walker |
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
#[path = "../shared/plain.rs"]
mod plain;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use bevy::prelude::*;

use crate::{
    plain::Moment,
    scene::{Rail, ScenePlugin, Walker},
    shared::{start::Example, window},
};

const TITLE: &str = "a walk through a curtain";

fn main() -> ExitCode {
    Example {
        name: "curtain",
        about: "A walker pushes through a curtain on rings. Opens a window if possible, otherwise runs headless.",
        seconds: "9",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("O", "open, close the curtain"), ("Up, Down", "faster, slower walker")];
            let mut app = window::app(TITLE, ScenePlugin, scene::SHOT, &keys);
            app.insert_resource(grid).add_systems(Update, press_keys);
            window::run(app)
        },
        headless: |view, grid, options| {
            let moment = Moment {
                at: scene::PARTED_AT,
                shot: scene::SHOT,
                file: "curtain.png",
            };
            plain::run((TITLE, ScenePlugin), &moment, view, grid, options)
        },
    }
    .run()
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut rail: ResMut<Rail>,
    mut walkers: Query<&mut Walker>,
) {
    if keys.just_pressed(KeyCode::KeyO) {
        rail.is_open = !rail.is_open;
    }
    for mut walker in &mut walkers {
        for (key, change) in [(KeyCode::ArrowUp, 0.25), (KeyCode::ArrowDown, -0.25)] {
            if keys.just_pressed(key) {
                walker.speed = (walker.speed + change).clamp(0.0, 4.0);
            }
        }
    }
}
