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
//! | Left drag on a cloth | pull it |
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

mod models;
mod scene;

use std::process::ExitCode;

use bevy::prelude::*;
use examples_shared::{report, stage::Shot, start::Example};

fn main() -> ExitCode {
    Example {
        name: "balloon",
        about: "Balloons are inflated.",
        title: "balloons",
        seconds: "6",
        // Rings of triangles on either side.
        particles: 16,
        shot: Shot {
            from: Vec3::new(0.4, 1.1, 2.6),
            focus: Vec3::new(0.03, 1.02, 0.0),
            fov: 0.42,
        },
        drawn_at: 4.0,
        scene: scene::build,
        report: report::plain,
    }
    .run()
}
