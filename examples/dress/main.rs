//! A skirt on a dressmaker's figure that spins: it flies up, and wraps around the hips when the figure stops.
//!
//! The skirt is a ring-shaped mesh. `Pin::at_rest` selects its inner edge, and `ClothAttachments` tie that edge to the
//! figure. Hips and legs are colliders. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example dress                         # a window, or headless where no window opens
//! cargo run --example dress -- --headless --out DIR # no window: prints a report, saves DIR/dress.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | T | spin, stand still |
//! | Up, Down | spin faster, slower |
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
        name: "dress",
        about: "A skirt on a figure that spins.",
        title: "a skirt that spins",
        seconds: "9",
        // From the waist to the hem.
        particles: 18,
        // All of the figure, from a little above its waist.
        shot: Shot {
            from: Vec3::new(0.8, 1.35, 2.85),
            focus: Vec3::new(0.0, 0.87, 0.0),
            fov: 0.52,
        },
        // As the skirt flies.
        drawn_at: 3.4,
        scene: scene::build,
        report: report::plain,
    }
    .run()
}
