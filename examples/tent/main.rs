//! A pavilion in gusty wind.
//!
//! Roof and walls are meshes made in code. `Pin::at_rest` pins them where poles and pegs hold them, by position in the
//! mesh. The pennant on top is cut from triangles and attached to its pole. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example tent                         # a window, or headless where no window opens
//! cargo run --example tent -- --headless --out DIR # no window: prints a report, saves DIR/tent.png
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
        name: "tent",
        about: "A pavilion in gusty wind.",
        title: "a pavilion in gusty wind",
        seconds: "8",
        // From the peak to the hem of the roof.
        particles: 18,
        // All of it, from somebody's height.
        shot: Shot {
            from: Vec3::new(2.6, 1.6, 8.6),
            focus: Vec3::new(0.15, 1.88, 0.0),
            fov: 0.50,
        },
        drawn_at: 5.2,
        scene: scene::build,
        report: report::plain,
    }
    .run()
}
