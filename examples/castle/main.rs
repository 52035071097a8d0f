//! A castle with sixty flags in one wind.
//!
//! Equal flags share their rest shape, springs and tree. All flags move at once, on all threads. `GlobalClothLod` moves
//! distant flags in fewer ticks. The scene is in `scene.rs`.
//!
//! ```sh
//! cargo run --example castle                         # a window, or headless where no window opens
//! cargo run --example castle -- --headless --out DIR # no window: prints a report, saves DIR/castle.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | stronger, weaker wind |
//! | D | level of detail on, off |
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
#[path = "../shared/plain.rs"]
mod plain;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    plain::Moment,
    scene::ScenePlugin,
    shared::{start::Example, window},
};

const TITLE: &str = "a castle with sixty flags";

fn main() -> ExitCode {
    Example {
        name: "castle",
        about: "Sixty flags in the wind on a castle. Opens a window if possible, otherwise runs headless.",
        seconds: "5",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [
                ("Up, Down", "stronger, weaker wind"),
                ("D", "level of detail on, off"),
            ];
            let mut app = window::app(TITLE, ScenePlugin, scene::SHOT, &keys);
            app.insert_resource(grid).add_systems(Update, press_keys);
            window::run(app)
        },
        headless: |view, grid, options| {
            let moment = Moment {
                at: scene::DRAWN_AT,
                shot: scene::SHOT,
                file: "castle.png",
            };
            plain::run((TITLE, ScenePlugin), &moment, view, grid, options)
        },
    }
    .run()
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut wind: ResMut<ClothWind>,
    lod: Option<Res<GlobalClothLod>>,
    mut commands: Commands,
) {
    if keys.just_pressed(KeyCode::KeyD) {
        match lod {
            Some(_) => commands.remove_resource::<GlobalClothLod>(),
            None => commands.insert_resource(GlobalClothLod(ClothLod::default())),
        }
    }
    for (key, factor) in [(KeyCode::ArrowUp, 1.25), (KeyCode::ArrowDown, 0.8)] {
        if keys.just_pressed(key) {
            wind.velocity *= factor;
        }
    }
}
