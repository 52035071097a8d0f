//! A flag in the wind, on a pole that sways.
//!
//! The flag's left column is attached to the pole, and the resource `ClothWind` is all that it takes to blow: a velocity, gusts and
//! turbulence. The keys change that resource and nothing else. See `scene.rs`.
//!
//! ```sh
//! cargo run --example flag               # a window, or a report where there is none
//! cargo run --example flag -- --headless # a report and a picture
//! ```
//!
//! | control | what it does |
//! |---|---|
//! | left drag, right drag, wheel | orbit, pan, zoom |
//! | Up, Down | a stronger, weaker wind |
//! | Left, Right | the wind turns |
//! | T | turbulence and gusts on and off |
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

const TITLE: &str = "a flag in the wind";

fn main() -> ExitCode {
    Example {
        name: "flag",
        about: "A flag blows on a pole that sways. Opens a window where it can, and runs headless otherwise.",
        seconds: "8",
        particles: scene::PARTICLES,
        window: |grid| {
            let keys = [("Up, Down", "stronger, weaker wind"), ("Left, Right", "turn the wind"), ("T", "turbulence on, off")];
            let mut app = window::app(TITLE, ScenePlugin, scene::SHOT, &keys);
            app.insert_resource(grid).add_systems(Update, press_keys);
            window::run(app)
        },
        headless: |view, grid, options| {
            let moment = Moment {
                at: scene::DRAWN_AT,
                shot: scene::SHOT,
                file: "flag.png",
            };
            plain::run((TITLE, ScenePlugin), &moment, view, grid, options)
        },
    }
    .run()
}

/// From one press to the next (m/s, rad).
const STRONGER: f32 = 2.0;
const TURN: f32 = 0.3;

fn press_keys(keys: Res<ButtonInput<KeyCode>>, mut wind: ResMut<ClothWind>) {
    let pressed = |key| f32::from(u8::from(keys.just_pressed(key)));
    let stronger = STRONGER * (pressed(KeyCode::ArrowUp) - pressed(KeyCode::ArrowDown));
    let turn = TURN * (pressed(KeyCode::ArrowLeft) - pressed(KeyCode::ArrowRight));
    if stronger != 0.0 || turn != 0.0 {
        let speed = wind.velocity.length();
        let direction = wind.velocity.try_normalize().unwrap_or(Vec3::X);
        // Never quite none: it keeps its direction.
        let speed = (speed + stronger).clamp(0.01, 40.0);
        wind.velocity = Quat::from_rotation_y(turn) * direction * speed;
    }
    if keys.just_pressed(KeyCode::KeyT) {
        let is_calm = wind.turbulence == 0.0;
        let ClothWind {
            gusts, turbulence, ..
        } = scene::wind();
        wind.turbulence = if is_calm { turbulence } else { 0.0 };
        wind.gusts = if is_calm { gusts } else { 0.0 };
    }
}
