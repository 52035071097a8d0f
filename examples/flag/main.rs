//! A flag in the wind, on a swaying pole.
//!
//! `ClothAttachments` tie the flag's left column to the pole. The resource `ClothWind` blows it: a velocity, gusts and
//! turbulence. The keys change only that resource (`examples/shared/windy.rs`). The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example flag                         # a window, or headless where no window opens
//! cargo run --example flag -- --headless --out DIR # no window: prints a report, saves DIR/flag.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | stronger, weaker wind |
//! | Left, Right | turn the wind |
//! | T | turbulence and gusts on, off |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloth |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

mod scene;

use std::process::ExitCode;

use bevy::prelude::*;
use examples_shared::{report, stage::Shot, start::Example};

fn main() -> ExitCode {
    Example {
        name: "flag",
        about: "A flag in the wind, on a swaying pole.",
        title: "a flag in the wind",
        seconds: "8",
        // Along the flag; down it there are two thirds as many.
        particles: 48,
        // The flag, from below.
        shot: Shot {
            from: Vec3::new(2.0, 1.3, 4.4),
            focus: Vec3::new(0.8, 2.08, 0.0),
            fov: 0.46,
        },
        drawn_at: 6.0,
        scene: scene::build,
        report: report::plain,
    }
    .run()
}
