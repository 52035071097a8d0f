//! The paper's scene: a ball, moved by rapier, travels through a hanging cloth and back. One half of the cloth shows its
//! fabric, the other the bounding spheres of the fifth level of its tree: red and dark where the ball touches them or may
//! within the tick, green and bright where it does not, faint where the search had no need to look.
//!
//! The paper's cloth has 16 × 16 particles; the example's is finer, so that it drapes as fabric does.
//!
//! ```sh
//! cargo run --example ball                                      # a window, or a report where there is none
//! cargo run --example ball -- --particles 16                    # the paper's grid
//! cargo run --example ball -- --headless --seconds 20 --json    # a report as one JSON object, and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | Space | pause and go on |
//! | N | single step, while paused |
//! | L | next level of the tree |
//! | G | springs on and off |
//! | B | next way to search: volume (sphere, AABB, OBB, k-DOP) and rule (rest shape, refit, paper) |
//! | C | contact by particles or triangles, or as the ball's size asks for |
//! | M | next material |
//! | Up, Down | faster and slower ball |
//! | R | new cloth |
//! | P | panel on and off |

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
        about: "A ball strikes a hanging cloth. Opens a window where it can, and runs headless otherwise.",
        seconds: "12",
        // So fine that it drapes as fabric does.
        particles: 48,
        window: controls::run,
        headless: headless::run,
    }
    .run()
}
