//! A hero who runs, jumps and teleports, in a cape.
//!
//! `assets/models/hero.glb` has a skeleton, three animations, and a cape that is skinned to it, on which `_MAX_DISTANCE` is painted: how
//! far each vertex may be from its place in the pose. Three components make cloth of it (`dress` in `scene.rs`); `ClothBones` beside
//! the hero puts colliders on bones by their names, and `ClothInertia` says how much of the hero's motion the cape feels. A teleport is
//! nothing but a `Transform` that jumps.
//!
//! ```sh
//! cargo run --example cape                 # a window, or a report where there is none
//! cargo run --example cape -- --headless   # a report and a picture
//! cargo run --example cape -- --write-model # makes the glTF file anew, see `model/`
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | W | runs, or stands still |
//! | J | jumps |
//! | T | teleports, half around the circle |
//! | Up, Down | a stronger, weaker wind |
//! | Space | pause and go on |
//! | N | single step, while paused |
//! | L | next level of the tree, beginning with none |
//! | G | springs on and off |
//! | B | next way to search: what is best, all particles, or a tree of some volume and rule |
//! | C | contact by particles or triangles, or as each shape's size asks for |
//! | M | next material |
//! | R | new cloth |
//! | P | panel on and off |

mod hero;
#[path = "../shared/measured.rs"]
mod measured;
mod model;
#[path = "../shared/plain.rs"]
mod plain;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::{env, path::Path, process::ExitCode};

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    hero::{Hero, ScriptPlugin},
    plain::Moment,
    scene::ScenePlugin,
    shared::{start::Example, window},
};

const TITLE: &str = "a cape that runs, jumps and teleports";

fn main() -> ExitCode {
    if env::args().any(|argument| argument == "--write-model") {
        return write_model();
    }
    Example {
        name: "cape",
        about: "A hero runs, jumps and teleports in a cape. Opens a window where it can, and runs headless otherwise.",
        seconds: "9",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [
                ("W", "run, stand still"),
                ("J", "jump"),
                ("T", "teleport"),
                ("Up, Down", "stronger, weaker wind"),
            ];
            let mut app = window::app(TITLE, ScenePlugin, scene::SHOT, &keys);
            app.insert_resource(grid).add_systems(Update, press_keys);
            window::run(app)
        },
        headless: |view, grid, options| {
            let moment = Moment {
                at: scene::DRAWN_AT,
                shot: scene::SHOT,
                file: "cape.png",
            };
            let scene = |app: &mut App| {
                app.add_plugins((ScenePlugin, ScriptPlugin));
            };
            plain::run((TITLE, scene), &moment, view, grid, options)
        },
    }
    .run()
}

fn write_model() -> ExitCode {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("assets")
        .join(scene::HERO);
    match model::write(&path) {
        Ok(()) => {
            println!("{}", path.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{}: {error}", path.display());
            ExitCode::FAILURE
        }
    }
}

/// From one press to the next (m/s).
const STRONGER: f32 = 2.0;

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut heroes: Query<&mut Hero>,
    mut wind: ResMut<ClothWind>,
) {
    for mut hero in &mut heroes {
        if keys.just_pressed(KeyCode::KeyW) {
            hero.runs = !hero.runs;
        }
        hero.jumps |= keys.just_pressed(KeyCode::KeyJ);
        hero.teleports |= keys.just_pressed(KeyCode::KeyT);
    }
    for (key, change) in [
        (KeyCode::ArrowUp, STRONGER),
        (KeyCode::ArrowDown, -STRONGER),
    ] {
        if keys.just_pressed(key) {
            wind.velocity.x = (wind.velocity.x + change).clamp(-20.0, 20.0);
        }
    }
}
