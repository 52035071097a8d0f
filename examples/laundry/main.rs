//! Laundry on a line. Take a peg off, or pull at anything.
//!
//! It is wet, more so below, and dries: a `ClothMaterialMap` scales its weight, and changes in every tick.
//! Pegs are entities that hold a few particles by `ClothAttachments`. Pressing one detaches them. In the window the mouse
//! pulls at cloth, by `ClothPickingPlugin`, which every example has. Without a window a script does both: a
//! `ClothRayCast` finds where the hand takes hold, and a `ClothGrab` is the hand. The scene is in `scene.rs`, the script in `headless.rs`.
//!
//! ```sh
//! cargo run --example laundry                         # a window, or headless where no window opens
//! cargo run --example laundry -- --headless --out DIR # no window: prints a report, saves DIR/laundry.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Click on a peg | take it off |
//! | H | hang everything up again |
//! | Left drag on a cloth | pull it |
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
        name: "laundry",
        about: "Laundry on a line, to be pulled at.",
        title: "laundry on a line",
        seconds: "8",
        // Along the upper edge of the sheet; the towels have fewer.
        particles: 40,
        // The whole line, from a child's height.
        shot: Shot {
            from: Vec3::new(1.1, 1.25, 4.6),
            focus: Vec3::new(0.0, 1.2, 0.0),
            fov: 0.55,
        },
        drawn_at: 4.4,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
