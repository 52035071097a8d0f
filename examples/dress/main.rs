//! A skirt on a dressmaker's figure that turns on its stand: the skirt flies up, and winds itself around the hips when the figure
//! stops.
//!
//! The skirt is a mesh, a ring of cloth. What lies on its inner edge is attached to the figure by `Pin::at_rest`, and the figure's
//! hips and legs are colliders below it. Both are in `scene.rs`.
//!
//! ```sh
//! cargo run --example dress               # a window, or a report where there is none
//! cargo run --example dress -- --headless # a report and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | T | twirls and rests in turns, or stands still |
//! | Up, Down | turns faster, slower |
//! | Space | pause and go on |
//! | N | single step, while paused |
//! | L | next level of the tree, beginning with none |
//! | G | springs on and off |
//! | B | next way to search: what is best, all particles, or a tree of some volume and rule |
//! | C | contact by particles or triangles, or as each shape's size asks for |
//! | M | next material |
//! | R | new cloth |
//! | P | panel on and off |

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

const TITLE: &str = "a skirt that twirls";

fn main() -> ExitCode {
    Example {
        name: "dress",
        about: "A skirt on a figure that turns. Opens a window where it can, and runs headless otherwise.",
        seconds: "9",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("T", "twirl, stand still"), ("Up, Down", "faster, slower")];
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
