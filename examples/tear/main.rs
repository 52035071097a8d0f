//! A banner and a sword. Slash it, scratch it with the mouse, or pull at it until it tears.
//!
//! The banner has a `ClothTearing`, so it tears where it is loaded too much. A `ClothBlade` cuts it where the
//! sword goes, from its place in one tick to that in the next. In the window the mouse cuts in the same way while a key is held. Without a
//! window a script slashes. The scene is in `scene.rs`, the script in `headless.rs`.
//!
//! ```sh
//! cargo run --example tear                         # a window, or headless where no window opens
//! cargo run --example tear -- --headless --out DIR # no window: prints a report, saves DIR/tear.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | X | held: the mouse cuts |
//! | V | slash with the sword |
//! | H | mend the banner |
//! | Left drag on the banner | pull it, until it tears |
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
        name: "tear",
        about: "A banner, to be cut and torn.",
        title: "a banner and a sword",
        seconds: "8",
        // Along its upper edge.
        particles: 28,
        shot: Shot {
            from: Vec3::new(0.9, 1.35, 4.4),
            focus: Vec3::new(0.0, 1.35, 0.0),
            fov: 0.6,
        },
        drawn_at: 3.05,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
