//! The paper's scene: a ball, moved by rapier, travels through a hanging cloth of 16 × 16 particles and back.
//! The cloth's bounding spheres are red where the ball touches them and green where it does not.
//!
//! ```sh
//! cargo run --example ball                                      # a window, or a report where there is none
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
//! | M | next material |
//! | Up, Down | faster and slower ball |
//! | R | new cloth |
//! | P | panel on and off |

mod controls;
mod headless;
mod scene;
mod view;

use std::{path::PathBuf, process::ExitCode};

use clap::Parser;

use crate::view::View;

/// A ball strikes a hanging cloth. Opens a window where it can, and runs headless otherwise.
#[derive(Parser)]
struct Arguments {
    /// Run without a window, as fast as possible, and print a report
    #[arg(long)]
    headless: bool,
    /// Headless: how long to simulate (s)
    #[arg(long, value_name = "S", default_value_t = 12.0, value_parser = seconds)]
    seconds: f64,
    /// Headless: folder that ball.png is saved in, made if it is not there
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Headless: print the report as one JSON object
    #[arg(long)]
    json: bool,
    /// Only try whether this view can be had; what the program asks of itself
    #[arg(long, hide = true)]
    probe: Option<View>,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.1..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("expected a number of seconds from 0.1 to 3600".into()),
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Some(view) = arguments.probe {
        view.try_out();
        return ExitCode::SUCCESS;
    }
    if !arguments.headless {
        if View::Window.can_be_had() {
            return controls::run();
        }
        eprintln!("No window can be opened here: running headless.");
    }
    let view = if View::Offscreen.can_be_had() {
        View::Offscreen
    } else {
        View::Nothing
    };
    headless::run(view, arguments.seconds, &arguments.out, arguments.json)
}
