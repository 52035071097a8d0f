//! A ball falls into a hammock, which carries it.
//!
//! Rapier moves the ball. The hammock is a canvas that hangs by its four corners. A `ClothPushBack` beside the ball's
//! `RigidBody` lets the canvas push the ball. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example hammock                         # a window, or headless where no window opens
//! cargo run --example hammock -- --headless --out DIR # no window: prints a report, saves DIR/hammock.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | T | toss the ball up |
//! | Up, Down | double, halve the mass of the ball |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloth |
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
        name: "hammock",
        about: "A ball falls into a hammock.",
        title: "a ball in a hammock",
        seconds: "12",
        // Along the hammock; across it half as many.
        particles: 48,
        // The whole of it, from the side and a little above.
        shot: Shot {
            from: Vec3::new(1.5, 2.0, 4.0),
            focus: Vec3::new(0.0, 0.7, 0.0),
            fov: 0.5,
        },
        drawn_at: f64::INFINITY,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
