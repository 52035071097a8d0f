//! A ball in a hammock: rapier moves the ball, it falls into a canvas that hangs by its four corners, and the canvas pushes it
//! back and keeps it. All that this takes is a `ClothPushBack` beside the ball's `RigidBody`: see `scene.rs`.
//!
//! ```sh
//! cargo run --example hammock                                    # a window, or a report where there is none
//! cargo run --example hammock -- --headless --seconds 20 --json  # a report as one JSON object, and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | Space | pause and go on |
//! | N | single step, while paused |
//! | T | toss the ball up |
//! | Up, Down | a ball of twice, half the mass |
//! | L | next level of the tree, beginning with none |
//! | G | springs on and off |
//! | B | next way to search: what is best, all particles, or a tree of some volume and rule |
//! | C | contact by particles or triangles, or as the ball's size asks for |
//! | M | next material |
//! | R | new cloth, flat |
//! | P | panel on and off |

mod controls;
mod headless;
#[path = "../shared/measured.rs"]
mod measured;
#[path = "../shared/physics.rs"]
mod physics;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use crate::shared::start::Example;

fn main() -> ExitCode {
    Example {
        name: "hammock",
        about: "A ball falls into a hammock. Opens a window where it can, and runs headless otherwise.",
        seconds: "12",
        particles: scene::PARTICLES,
        window: controls::run,
        headless: headless::run,
    }
    .run()
}
