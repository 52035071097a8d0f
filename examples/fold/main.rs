//! A long cloth is let down on the floor by a bar, and falls into folds that lie on each other: contact of cloth with itself. How
//! many of its triangles pass through each other is counted by brute force, and shown: none.
//!
//! The cloth has a `ClothSelfCollision`, a thickness and friction between its layers; without it it would pass through itself (try
//! S). Take how it is attached to the bar, and how it is let go, from `scene.rs`.
//!
//! ```sh
//! cargo run --example fold               # a window, or a report where there is none
//! cargo run --example fold -- --headless # a report and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | S | contact of the cloth with itself on and off |
//! | Space | pause and go on |
//! | N | single step, while paused |
//! | L | next level of the tree, beginning with none |
//! | G | springs on and off |
//! | B | next way to search: what is best, all particles, or a tree of some volume and rule |
//! | C | contact by particles or triangles, or as each shape's size asks for |
//! | M | next material |
//! | R | new cloth, which is let down again |
//! | P | panel on and off |

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
        about: "A cloth is let down into folds that lie on each other. Opens a window where it can, and runs headless otherwise.",
        seconds: "5",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("S", "contact with itself on, off")];
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
