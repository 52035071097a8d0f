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
//! | Left drag on a cloth | pull it |
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
mod model;
mod scene;

use std::{env, process::ExitCode};

use bevy::prelude::*;
use examples_shared::{report, stage::Shot, start::Example, top};

fn main() -> ExitCode {
    if env::args().any(|argument| argument == "--write-model") {
        return write_model();
    }
    Example {
        name: "cape",
        about: "A hero runs, jumps and teleports in a cape.",
        title: "a hero in a cape",
        seconds: "9",
        particles: scene::PARTICLES,
        // All of the circle that the hero runs around, with room for a jump where it is nearest.
        shot: Shot {
            from: Vec3::new(-2.1, 2.2, 7.7),
            focus: Vec3::new(0.0, 1.08, 0.0),
            fov: 0.52,
        },
        // As the cape flies.
        drawn_at: 2.95,
        scene: scene::build,
        report: |mut run| {
            run.app.add_plugins(hero::ScriptPlugin);
            report::plain(run)
        },
    }
    .run()
}

fn write_model() -> ExitCode {
    let path = top().join("assets").join(scene::HERO);
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
