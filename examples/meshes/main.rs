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
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use crate::shared::{start::Example, window};

fn main() -> ExitCode {
    Example {
        name: "meshes",
        about: "A pennant, a poncho and a tent, each from a mesh. Opens a window if possible, otherwise runs headless.",
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
