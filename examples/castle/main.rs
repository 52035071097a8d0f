//! A castle with sixty flags in one wind.
//!
//! Equal flags share their rest shape, springs and tree. All flags move at once, on all threads. `GlobalClothLod` moves
//! distant flags in fewer ticks. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example castle                         # a window, or headless where no window opens
//! cargo run --example castle -- --headless --out DIR # no window: prints a report, saves DIR/castle.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | stronger, weaker wind |
//! | D | level of detail on, off |
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
        name: "castle",
        about: "Sixty flags in the wind on a castle.",
        title: "a castle with sixty flags",
        seconds: "5",
        // Along a flag; down it there are half as many.
        particles: 24,
        shot: Shot {
            from: Vec3::new(15.0, 9.5, 34.0),
            focus: Vec3::new(1.0, 5.6, 0.0),
            fov: 0.52,
        },
        drawn_at: 3.0,
        scene: scene::build,
        report: report::plain,
    }
    .run()
}
