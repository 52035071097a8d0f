//! A curtain in two halves on rings, and a walker who pushes through it.
//!
//! Each ring is an entity on the rail, and `ClothAttachments` tie a half's top row to its rings. Rings that move
//! together gather the cloth into pleats. The walker is an entity with colliders as children. The scene is in
//! `scene.rs`.
//!
//! ```sh
//! cargo run --example curtain                         # a window, or headless where no window opens
//! cargo run --example curtain -- --headless --out DIR # no window: prints a report, saves DIR/curtain.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | O | open, close the curtain |
//! | Up, Down | faster, slower walker |
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
        name: "curtain",
        about: "A walker pushes through a curtain on rings.",
        title: "a walk through a curtain",
        seconds: "9",
        // Across a half of the curtain; down it there are half as many again.
        particles: 41,
        // From where the walker comes to, a little from the side.
        shot: Shot {
            from: Vec3::new(1.6, 1.66, 4.25),
            focus: Vec3::new(0.0, 1.12, 0.0),
            fov: 0.56,
        },
        // As the walker comes out between the halves.
        drawn_at: 2.6,
        scene: scene::build,
        report: report::plain,
    }
    .run()
}
