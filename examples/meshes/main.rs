//! Cloth from any mesh:
//!
//! - a pennant, from triangles in code
//! - a poncho with a hole, from a mesh asset made in code
//! - a tent, from a glTF file with painted pins, closed along its seams
//!
//! Each is an entity with a `Cloth` and `Pins`, or `ClothAttachments` to an entity by its name. Poncho and tent have
//! split vertices at their seams, for textures and normals; the plugin joins them. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example meshes                         # a window, or headless where no window opens
//! cargo run --example meshes -- --headless --out DIR # no window: prints a report, saves ridge_tent.png, poncho.png and pennant.png in DIR
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloths |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

mod headless;
mod models;
mod scene;

use std::process::ExitCode;

use bevy::prelude::*;
use examples_shared::{stage::Shot, start::Example};

fn main() -> ExitCode {
    Example {
        name: "meshes",
        about: "A pennant, a poncho and a tent, each from a mesh.",
        title: "meshes as cloth",
        seconds: "9",
        // Triangles along either side of the pennant, and rings of the poncho.
        particles: 24,
        shot: Shot {
            from: Vec3::new(0.3, 2.6, 8.8),
            focus: Vec3::new(0.05, 0.95, 0.0),
            fov: 0.46,
        },
        drawn_at: f64::INFINITY,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
