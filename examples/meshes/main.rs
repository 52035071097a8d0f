//! Any mesh is cloth: a pennant of triangles that the program gives, a poncho with a hole from a mesh asset that the program
//! makes, and a tent from a glTF file, closed along its seams, whose pins an artist has painted.
//!
//! Each is an entity with a `Cloth` and `Pins`, or attachments to an entity by its name; `scene.rs` has them one after the
//! other. The seams of poncho and tent are split in the asset, for their textures and normals, and hold all the same.
//!
//! ```sh
//! cargo run --example meshes               # a window, or a report where there is none
//! cargo run --example meshes -- --headless # a report and three pictures
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
//! | R | new cloths |
//! | P | panel on and off |

mod headless;
mod models;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use crate::shared::{start::Example, window};

fn main() -> ExitCode {
    Example {
        name: "meshes",
        about: "A pennant, a poncho and a tent, each from a mesh. Opens a window where it can, and runs headless otherwise.",
        seconds: "9",
        particles: scene::FINENESS,
        window: |grid| {
            let mut app = window::app("meshes as cloth", scene::ScenePlugin, scene::ALL, &[]);
            app.insert_resource(grid);
            window::run(app)
        },
        headless: headless::run,
    }
    .run()
}
