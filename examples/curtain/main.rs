//! A curtain of two halves that hang on rings, and somebody who walks through it, to and fro.
//!
//! Each ring is an entity on the rail, and a curtain's top row follows them by `ClothAttachments`: draw the rings together and the
//! cloth between them falls into pleats. The walker is a child of colliders. Both are in `scene.rs`.
//!
//! ```sh
//! cargo run --example curtain               # a window, or a report where there is none
//! cargo run --example curtain -- --headless # a report and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | O | draws the curtain open, and closed again |
//! | Up, Down | a faster, slower walker |
//! | Space | pause and go on |
//! | N | single step, while paused |
//! | L | next level of the tree, beginning with none |
//! | G | springs on and off |
//! | B | next way to search: what is best, all particles, or a tree of some volume and rule |
//! | C | contact by particles or triangles, or as each shape's size asks for |
//! | M | next material |
//! | R | new cloth |
//! | P | panel on and off |

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
        about: "Somebody walks through a curtain on rings. Opens a window where it can, and runs headless otherwise.",
        seconds: "9",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("O", "open, close"), ("Up, Down", "faster, slower walker")];
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
