//! The tablecloth trick: the cloth is pulled off a laid table so fast that the dishes stay where they are.
//!
//! Rapier moves plates, cups, bottle and candlestick. Cloth can't carry heavy bodies, and two solids that press it from
//! both sides pinch it. So the dishes stand on the table's own collider, raised by the cloth's thickness, and the cloth
//! slides through the gap. It moves around the dishes and never pushes them.
//!
//! No edge or corner of the table pokes through the cloth: the picture shows the number of cloth triangles that a table
//! edge crosses, counted by brute force.
//!
//! ```sh
//! cargo run --example table                         # a window, or headless where no window opens
//! cargo run --example table -- --headless --out DIR # no window: prints a report, saves DIR/table.png and DIR/table_pulled.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | T | pull the cloth off |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | lay the table again |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

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
        about: "A cloth is pulled off a laid table. Opens a window if possible, otherwise runs headless.",
        seconds: "4",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("T", "pull the cloth off")];
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
