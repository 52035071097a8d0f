//! Two sheer cloths of 64 × 64 particles fall over every shape there is. The first over a ball, a standing capsule, a box, and
//! a ring of marbles so small that the cloth is tested against them by its triangles; the second over a cylinder, a cone, a stone
//! by the convex hull of its mesh, a ring by the triangles of its own, and dunes that are a height field; below them, a floor that
//! is a plane.
//!
//! Each is an entity with a `ClothCollider`, a `Transform` and a mesh. Nothing is asked of the search: the plugin
//! chooses, and the panel and the report say what and why. Take the shapes' places from `scene.rs`.
//!
//! ```sh
//! cargo run --example shapes                                    # a window, or a report where there is none
//! cargo run --example shapes -- --headless --seconds 20 --json  # a report as one JSON object, and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | Space | pause and go on |
//! | N | single step, while paused |
//! | L | next level of the tree, beginning with none |
//! | G | springs on and off |
//! | B | next way to search: what is best, all particles, or a tree of some volume and rule |
//! | C | contact by particles or triangles, or as each shape's size asks for |
//! | M | next material |
//! | R | new cloth, which falls again |
//! | P | panel on and off |

mod headless;
#[path = "../shared/measured.rs"]
mod measured;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use crate::shared::{start::Example, window};

fn main() -> ExitCode {
    Example {
        name: "shapes",
        about: "Cloth falls over every shape there is. Opens a window where it can, and runs headless otherwise.",
        seconds: "6",
        particles: scene::PARTICLES,
        window: |grid| {
            let title = "cloth over every shape";
            let mut app = window::app(title, scene::ScenePlugin, scene::SHOT, &[]);
            app.insert_resource(grid);
            window::run(app)
        },
        headless: headless::run,
    }
    .run()
}
