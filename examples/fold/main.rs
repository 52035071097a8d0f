//! Self-collision: a long cloth is lowered onto the floor and falls into folds that lie on each other.
//!
//! `ClothSelfCollision` sets the thickness of the cloth and the friction between its layers. Without it the cloth
//! passes through itself: press S. The picture shows the number of triangle pairs that pass through each other, counted
//! by brute force: none. `scene.rs` attaches the cloth to a bar and releases it.
//!
//! ```sh
//! cargo run --example fold                         # a window, or headless where no window opens
//! cargo run --example fold -- --headless --out DIR # no window: prints a report, saves DIR/fold.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | S | self-collision on, off |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloth, which is lowered again |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

#[path = "../shared/figure.rs"]
mod figure;
mod headless;
#[path = "../shared/measured.rs"]
mod measured;
mod scene;
#[path = "../shared/mod.rs"]
mod shared;

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::shared::{start::Example, window};

fn main() -> ExitCode {
    Example {
        name: "fold",
        about: "A cloth is lowered into folds that lie on each other. Opens a window if possible, otherwise runs headless.",
        seconds: "5",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("S", "self-collision on, off")];
            let mut app = window::app("folds", scene::ScenePlugin, scene::SHOT, &keys);
            app.insert_resource(grid).add_systems(Update, press_key);
            window::run(app)
        },
        headless: headless::run,
    }
    .run()
}

/// Without contact with itself the cloth passes through itself, and the figure says so.
fn press_key(
    keys: Res<ButtonInput<KeyCode>>,
    cloths: Query<(Entity, Has<ClothSelfCollision>), With<Cloth>>,
    mut commands: Commands,
) {
    if !keys.just_pressed(KeyCode::KeyS) {
        return;
    }
    for (cloth, touches_itself) in &cloths {
        if touches_itself {
            commands.entity(cloth).remove::<ClothSelfCollision>();
        } else {
            commands.entity(cloth).insert(scene::contact());
        }
    }
}
