//! Self-collision: a long cloth is lowered onto the floor and falls into folds that lie on each other.
//!
//! `ClothSelfCollision` sets the thickness of the cloth and the friction between its layers. Without it the cloth
//! passes through itself: press S. The picture shows the number of triangle pairs that pass through each other, counted
//! by brute force: none. `scene.rs` attaches the cloth to a bar and releases it.
//!
//! ```sh
//! cargo run --example fold                         # a window, or headless where no window opens
//! cargo run --example fold -- --headless --out DIR # no window: prints a report, saves DIR/fold.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | S | self-collision on, off |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloth, which is lowered again |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

mod headless;
mod scene;

use std::process::ExitCode;

use bevy::prelude::*;
use examples_shared::{stage::Shot, start::Example};

fn main() -> ExitCode {
    Example {
        name: "fold",
        about: "A cloth is lowered into folds that lie on each other.",
        title: "folds",
        seconds: "5",
        // Across the cloth; down it there are half as many again.
        particles: 24,
        shot: Shot {
            from: Vec3::new(0.72, 0.52, 1.0),
            focus: Vec3::new(0.0, 0.17, 0.0),
            fov: 0.5,
        },
        // Some of the cloth lies in folds, the rest hangs.
        drawn_at: 1.65,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
