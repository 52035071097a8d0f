//! Ropes: two slings hold a swing's plank, four ties a sail above it.
//!
//! A rope is a cloth of its own, `Cloth::rope`. Rapier moves the plank, and the ropes push it by its `ClothPushBack`. Each tie is
//! sewn to a corner of the sail by a `ClothSeam`. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example ropes                         # a window, or headless where no window opens
//! cargo run --example ropes -- --headless --out DIR # no window: prints a report, saves DIR/ropes.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | T | push the swing |
//! | Left drag on a rope or the sail | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
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
        name: "ropes",
        about: "A swing in two ropes, below a sail that four of them tie.",
        title: "a swing and a sail",
        seconds: "8",
        // Along the sail.
        particles: 28,
        shot: Shot {
            from: Vec3::new(2.4, 3.3, 5.6),
            focus: Vec3::new(0.0, 1.45, 0.0),
            fov: 0.6,
        },
        drawn_at: 4.4,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
