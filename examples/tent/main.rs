//! A pavilion in gusty wind.
//!
//! Roof and walls are meshes made in code. `Pin::at_rest` pins them where poles and pegs hold them, by position in the
//! mesh. The pennant on top is cut from triangles and attached to its pole. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example tent                         # a window, or headless where no window opens
//! cargo run --example tent -- --headless --out DIR # no window: prints a report, saves DIR/tent.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | stronger, weaker wind |
//! | Left, Right | turn the wind |
//! | T | turbulence and gusts on, off |
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
#[path = "../shared/turned.rs"]
mod turned;
#[path = "../shared/windy.rs"]
mod windy;

use std::process::ExitCode;

use bevy::prelude::*;

use crate::{
    plain::Moment,
    scene::ScenePlugin,
    shared::{start::Example, window},
};

const TITLE: &str = "a pavilion in gusty wind";

fn main() -> ExitCode {
    Example {
        name: "tent",
        about: "A pavilion in gusty wind. Opens a window if possible, otherwise runs headless.",
        seconds: "8",
        particles: scene::PARTICLES,
        window: |grid| {
            let mut app = window::app(TITLE, ScenePlugin, scene::SHOT, &windy::KEYS);
            app.insert_resource(grid)
                .add_systems(Update, windy::press_keys);
            window::run(app)
        },
        headless: |view, grid, options| {
            let moment = Moment {
                at: scene::DRAWN_AT,
                shot: scene::SHOT,
                file: "tent.png",
            };
            plain::run((TITLE, ScenePlugin), &moment, view, grid, options)
        },
    }
    .run()
}
