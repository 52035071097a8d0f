//! An arm that bends in a wide sleeve. The collider is the arm's own skinned mesh.
//!
//! `ClothCollider::mesh()` on the entity with the `SkinnedMesh` is all that the arm needs: its triangles follow the joints. The
//! scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example sleeve                         # a window, or headless where no window opens
//! cargo run --example sleeve -- --headless --out DIR # no window: prints a report, saves DIR/sleeve.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | T | bend, hold still |
//! | Up, Down | bend faster, slower |
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
        name: "sleeve",
        about: "An arm that bends in a sleeve.",
        title: "an arm that bends in a sleeve",
        seconds: "8",
        // From the shoulder to the hem.
        particles: 24,
        shot: Shot {
            from: Vec3::new(0.75, 1.25, 1.55),
            focus: Vec3::new(0.12, 1.0, 0.0),
            fov: 0.52,
        },
        // As the forearm is up.
        drawn_at: 4.7,
        scene: scene::build,
        report: report::plain,
    }
    .run()
}
