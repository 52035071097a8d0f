//! A hero who runs, jumps and teleports in a cape.
//!
//! `assets/models/hero.glb` has a skeleton, three animations and a skinned cape. Its vertex attribute `_MAX_DISTANCE`
//! limits how far each vertex may leave its animated place. `Cloth`, `Pins` and `ClothSkin` make the cape a cloth
//! (`dress` in `scene.rs`).
//!
//! On the hero, `ClothBones` adds colliders to bones by name, and `ClothInertia` sets the share of the hero's motion
//! that the cape feels. For a teleport the example just sets the `Transform`.
//!
//! ```sh
//! cargo run --example cape                         # a window, or headless where no window opens
//! cargo run --example cape -- --headless --out DIR # no window: prints a report, saves DIR/cape.png
//! cargo run --example cape -- --write-model        # writes the glTF file again, see `model/`
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | W | run, stand still |
//! | J | jump |
//! | T | teleport to the other side of the circle |
//! | Up, Down | stronger, weaker wind |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloth |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

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

const TITLE: &str = "a hero in a cape";

fn main() -> ExitCode {
    if env::args().any(|argument| argument == "--write-model") {
        return write_model();
    }
    Example {
        name: "cape",
        about: "A hero runs, jumps and teleports in a cape. Opens a window if possible, otherwise runs headless.",
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
