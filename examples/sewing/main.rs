//! A shirt that is sewn around a figure from its flat pattern. Then the figure walks.
//!
//! Six flat panels hang in front of and behind a figure of capsules: front, back, and two for each sleeve. `ClothSeam`s join
//! them: at the shoulders, at the sides, along the sleeves, and around the armholes. They close in two seconds, while there
//! is no gravity, as a program for patterns dresses a figure. The scene is in `scene.rs`, the report in `headless.rs`.
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
        about: "A shirt that is sewn around a figure from its flat pattern.",
        title: "a shirt, sewn around a figure",
        seconds: "8",
        // Along the upper edge of a panel.
        particles: 25,
        // The whole figure, a little from the side.
        shot: Shot {
            from: Vec3::new(1.2, 1.65, 2.9),
            focus: Vec3::new(0.0, 1.05, 0.0),
            fov: 0.6,
        },
        drawn_at: 4.8,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
