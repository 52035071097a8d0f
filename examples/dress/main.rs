//! A skirt on a dressmaker's figure that spins: it flies up, and wraps around the hips when the figure stops.
//!
//! The skirt is a ring-shaped mesh. `Pin::at_rest` selects its inner edge, and `ClothAttachments` tie that edge to the
//! figure. Hips and legs are colliders. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example dress                         # a window, or headless where no window opens
//! cargo run --example dress -- --headless --out DIR # no window: prints a report, saves DIR/dress.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | T | spin, stand still |
//! | Up, Down | spin faster, slower |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloth |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

#[path = "../shared/measured.rs"]
mod measured;
mod models;
#[path = "../shared/plain.rs"]
mod plain;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;
#[path = "../shared/turned.rs"]
mod turned;

use std::process::ExitCode;

use bevy::prelude::*;

use crate::{
    plain::Moment,
    scene::{Figure, ScenePlugin},
    shared::{start::Example, window},
};

const TITLE: &str = "a skirt that spins";

fn main() -> ExitCode {
    Example {
        name: "dress",
        about: "A skirt on a figure that spins. Opens a window if possible, otherwise runs headless.",
        seconds: "9",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("T", "spin, stand still"), ("Up, Down", "spin faster, slower")];
            let mut app = window::app(TITLE, ScenePlugin, scene::SHOT, &keys);
            app.insert_resource(grid).add_systems(Update, press_keys);
            window::run(app)
        },
        headless: |view, grid, options| {
            let moment = Moment {
                at: scene::DRAWN_AT,
                shot: scene::SHOT,
                file: "dress.png",
            };
            plain::run((TITLE, ScenePlugin), &moment, view, grid, options)
        },
    }
    .run()
}

fn press_keys(keys: Res<ButtonInput<KeyCode>>, mut figures: Query<&mut Figure>) {
    for mut figure in &mut figures {
        if keys.just_pressed(KeyCode::KeyT) {
            figure.twirls = !figure.twirls;
        }
        for (key, change) in [(KeyCode::ArrowUp, 0.5), (KeyCode::ArrowDown, -0.5)] {
            if keys.just_pressed(key) {
                figure.speed = (figure.speed + change).clamp(0.0, 10.0);
            }
        }
    }
}
