//! A tablecloth over a table that is laid for two, and the trick with it: it is pulled away so fast that all stays where it is.
//!
//! Rapier moves plates, cups, bottle and candlestick. They stand on the table, higher by the thickness of the cloth, so that the
//! cloth has its place between them and the table: cloth does not carry what is heavy, and is pinched where two solids press it.
//! So the cloth goes around cups, bottle and candlestick, and does not push them: in this scene friction takes nothing along.
//! It shows neither an edge nor a corner of the table: how many of its triangles an edge of the table passes through is counted
//! by brute force, and shown.
//!
//! ```sh
//! cargo run --example table               # a window, or a report where there is none
//! cargo run --example table -- --headless # a report and two pictures
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | T | pull the cloth away |
//! | R | lay the table again |
//! | Space | pause and go on |
//! | N | single step, while paused |
//! | L | next level of the tree, beginning with none |
//! | G | springs on and off |
//! | B | next way to search: what is best, all particles, or a tree of some volume and rule |
//! | C | contact by particles or triangles, or as each shape's size asks for |
//! | M | next material |
//! | P | panel on and off |

mod edges;
#[path = "../shared/figure.rs"]
mod figure;
mod headless;
#[path = "../shared/measured.rs"]
mod measured;
#[path = "../shared/physics.rs"]
mod physics;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;
mod things;

use std::process::ExitCode;

use bevy::prelude::*;

use crate::shared::{start::Example, window};

fn main() -> ExitCode {
    Example {
        name: "table",
        about: "A cloth is pulled off a table that is laid. Opens a window where it can, and runs headless otherwise.",
        seconds: "4",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("T", "pull the cloth away")];
            let mut app = window::app("a tablecloth", scene::ScenePlugin, scene::SHOT, &keys);
            app.insert_resource(grid).add_systems(Update, press_key);
            window::run(app)
        },
        headless: headless::run,
    }
    .run()
}

fn press_key(keys: Res<ButtonInput<KeyCode>>, mut pull: ResMut<scene::Pull>) {
    if keys.just_pressed(KeyCode::KeyT) {
        pull.begin();
    }
}
