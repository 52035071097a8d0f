//! The tablecloth trick: the cloth is pulled off a laid table so fast that the dishes stay where they are.
//!
//! Rapier moves plates, cups, bottle and candlestick, which stand on the cloth. The table holds them through it, and while
//! it goes, friction takes them along by some centimetres. Then they come down by its thickness.
//!
//! No edge or corner of the table pokes through the cloth: the picture shows the number of cloth triangles that a table
//! edge crosses, counted by brute force.
//!
//! ```sh
//! cargo run --example table                         # a window, or headless where no window opens
//! cargo run --example table -- --headless --out DIR # no window: prints a report, saves DIR/table.png and DIR/table_pulled.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | T | pull the cloth off |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | lay the table again |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

mod edges;
mod headless;
mod scene;
mod things;

use std::process::ExitCode;

use bevy::prelude::*;
use examples_shared::{stage::Shot, start::Example};

fn main() -> ExitCode {
    Example {
        name: "table",
        about: "A cloth is pulled off a laid table.",
        title: "a tablecloth",
        seconds: "4",
        // Along the cloth; across it in proportion.
        particles: 40,
        // From the side from which the cloth is pulled.
        shot: Shot {
            from: Vec3::new(1.45, 1.6, 2.0),
            focus: Vec3::new(0.05, 0.58, 0.0),
            fov: 0.5,
        },
        drawn_at: f64::INFINITY,
        scene: scene::build,
        report: headless::report,
    }
    .run()
}
