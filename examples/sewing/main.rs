//! A tunic that is sewn around a figure, which then turns.
//!
//! Two panels hang in front of and behind a figure of capsules and balls. Two `ClothSeam`s join them: one at both shoulders,
//! the other at both sides below the arms. They close in two seconds, while there is no gravity, as a program for patterns
//! dresses a figure. The scene is in `scene.rs`, the report in `headless.rs`.
//!
//! ```sh
//! cargo run --example sewing                         # a window, or headless where no window opens
//! cargo run --example sewing -- --headless --out DIR # no window: prints a report, saves DIR/sewing.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | U | undo the side seams, sew them again |
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
        name: "sewing",
        about: "A tunic that is sewn around a figure.",
        title: "a tunic, sewn around a figure",
        seconds: "8",
        // Along the upper edge of a panel.
        particles: 29,
        // The whole figure, a little from the side.
        shot: Shot {
            from: Vec3::new(1.1, 1.5, 2.3),
            focus: Vec3::new(0.0, 1.05, 0.0),
            fov: 0.6,
        },
        drawn_at: 5.5,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
