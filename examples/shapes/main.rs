//! Two sheer cloths of 64 × 64 particles fall over every collider shape.
//!
//! The first falls over a ball, a capsule, a box, and a ring of marbles so small that contact goes by the cloth's
//! triangles. The second falls over a cylinder, a cone, the convex hull of a stone, the triangle mesh of a ring, and a
//! height field of dunes. The floor is a plane.
//!
//! Each shape is an entity with a `ClothCollider`, a `Transform` and a mesh. The plugin chooses the search by itself:
//! the panel and the report show the choice and its reason. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example shapes                                   # a window, or headless where no window opens
//! cargo run --example shapes -- --headless --out DIR           # no window: prints a report, saves DIR/shapes.png
//! cargo run --example shapes -- --headless --seconds 20 --json # a longer run, reported as one JSON object
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloths, which fall again |
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
        name: "shapes",
        about: "Cloth falls over every collider shape.",
        title: "cloth over every shape",
        seconds: "6",
        particles: 64,
        shot: Shot {
            from: Vec3::new(1.9, 3.0, 4.6),
            focus: Vec3::new(1.25, 0.02, 0.12),
            fov: 0.5,
        },
        drawn_at: f64::INFINITY,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
