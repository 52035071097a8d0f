//! A debug view of the contact search: a ball, moved by rapier, travels through a hanging cloth and back.
//!
//! One half of the cloth shows its fabric, the other the bounding spheres of the fifth level of its tree:
//!
//! - red and dark: the ball touches it, or may do so within the tick
//! - green and bright: the ball does not touch it
//! - faint: the search did not visit it
//!
//! The scene is that of the paper, with a finer cloth: 48 × 48 particles in place of 16 × 16. For a first look at
//! cloth, run `flag` or `curtain`.
//!
//! ```sh
//! cargo run --example ball                                   # a window, or headless where no window opens
//! cargo run --example ball -- --headless --out DIR           # no window: prints a report, saves DIR/ball.png
//! cargo run --example ball -- --particles 16                 # the paper's grid
//! cargo run --example ball -- --headless --seconds 20 --json # a longer run, reported as one JSON object
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | faster, slower ball |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloth |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

mod controls;
mod headless;
#[path = "../shared/measured.rs"]
mod measured;
#[path = "../shared/physics.rs"]
mod physics;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use crate::shared::start::Example;

fn main() -> ExitCode {
    Example {
        name: "ball",
        about: "Debug view: a ball travels through a hanging cloth. Opens a window if possible, otherwise runs headless.",
        seconds: "12",
        // So fine that it drapes as fabric does.
        particles: 48,
        window: controls::run,
        headless: headless::run,
    }
    .run()
}
