//! Balloons on sticks: two round sheets each, sewn together along their edge, and blown up.
//!
//! A closed mesh and a `ClothPressure` are all that it takes; the wrinkles along the edge are those of a real one, for a flat sheet
//! cannot become round without them. See `scene.rs`.
//!
//! ```sh
//! cargo run --example balloon               # a window, or a report where there is none
//! cargo run --example balloon -- --headless # a report and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | blows more in, lets some out |
//! | Left, Right | less, more wind |
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
        about: "Balloons are blown up. Opens a window where it can, and runs headless otherwise.",
        seconds: "6",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [
                ("Up, Down", "more, less gas"),
                ("Left, Right", "less, more wind"),
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
