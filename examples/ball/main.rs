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
//! | Left drag on a cloth | pull it |
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

mod headless;
mod scene;

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::plugin::ClothColliderSpeed;
use examples_shared::{arrows::up_down, start::Example, window::Keys};

fn main() -> ExitCode {
    Example {
        name: "ball",
        about: "Debug view: a ball travels through a hanging cloth.",
        title: "a ball and a cloth (debug view)",
        seconds: "12",
        // So fine that it drapes as fabric does.
        particles: 48,
        shot: scene::SHOT,
        drawn_at: f64::INFINITY,
        scene: |app| {
            app.add_plugins(scene::ScenePlugin)
                .add_plugins(Keys(&[("Up, Down", "faster, slower ball")]))
                .add_systems(Update, press_keys);
        },
        report: headless::report,
    }
    .run()
}

fn press_keys(keys: Res<ButtonInput<KeyCode>>, mut speeds: Query<&mut ClothColliderSpeed>) {
    for mut speed in &mut speeds {
        speed.0 = (speed.0 + 0.25 * up_down(&keys)).clamp(0.0, 10.0);
    }
}
