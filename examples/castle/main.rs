//! A castle with sixty flags in one wind.
//!
//! Flags that are alike share what is built of them, all of them are moved at once, on as many threads as there are, and those that are
//! far from the camera are moved in fewer ticks. See `scene.rs`.
//!
//! ```sh
//! cargo run --example castle               # a window, or a report where there is none
//! cargo run --example castle -- --headless # a report and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | a stronger, weaker wind |
//! | D | level of detail on and off |
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
        about: "Sixty flags blow on a castle. Opens a window where it can, and runs headless otherwise.",
        seconds: "5",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [
                ("Up, Down", "stronger, weaker wind"),
                ("D", "level of detail on and off"),
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
