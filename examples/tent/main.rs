//! A pavilion in gusty wind.
//!
//! Roof and walls are meshes that the program makes, pinned where the pavilion's poles and pegs hold them: `Pin::at_rest` asks the
//! position in the mesh. The pennant on its top is cut of triangles and attached to the pole. See `scene.rs`.
//!
//! ```sh
//! cargo run --example tent               # a window, or a report where there is none
//! cargo run --example tent -- --headless # a report and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | a stronger, weaker wind |
//! | Left, Right | the wind turns |
//! | T | turbulence and gusts on and off |
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
        about: "A pavilion stands in gusty wind. Opens a window where it can, and runs headless otherwise.",
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
