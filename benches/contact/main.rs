//! What contact costs, and particles or triangles? `cargo bench --profile dev --bench contact`, as CSV.
//!
//! First a cloth of 64², 2 m wide, at rest on a fixed ball of 0.5 m, in 20 sub-steps, and without the ball: a whole tick of each,
//! several times in turns (`-- rest` does only this).
//!
//! Then a ball is pressed six spacings deep into the middle of a cell of a cloth that is held by its rim, and held there. How
//! deep the flat triangles then are inside of the ball, and what a sub-step's response takes, by either narrow phase (`-- press`).
//!
//! Then a flag of 48 × 32 that is attached to a pole by its left column: a whole tick of it in an app, without a collider on the pole, with
//! a capsule of 2 cm, and with a cylinder (`-- pole`).

mod pole;
mod press;
mod resting;

use bevy_drape::{contact::NarrowPhase, solver::TickStep};
use pole::{Pole, flag};
use press::{SPACING, press};
use resting::rest;

/// How often each is measured, in turns.
const TURNS: u32 = 3;

fn main() {
    let arguments = std::env::args().skip(1);
    let names: Vec<String> = arguments.filter(|name| !name.starts_with('-')).collect();
    let wanted = |name: &str| names.is_empty() || names.iter().any(|wanted| wanted == name);
    if wanted("rest") {
        at_rest();
    }
    if wanted("press") {
        pressed();
    }
    if wanted("pole") {
        on_poles();
    }
}

fn at_rest() {
    println!("turn,test,ms_a_tick,times_without,ms_of_responses,deepest_triangle_mm");
    for turn in 0..TURNS {
        let without = rest(None).tick;
        for (name, narrow_phase) in [
            ("particles", NarrowPhase::Particles),
            ("triangles", NarrowPhase::Triangles),
        ] {
            let cost = rest(Some(narrow_phase));
            println!(
                "{turn},{name},{:.3},{:.2},{:.3},{:.3}",
                1.0e3 * cost.tick,
                cost.tick / without,
                1.0e3 * cost.response,
                1.0e3 * cost.deepest,
            );
        }
        println!("{turn},without,{:.3},1,0,0", 1.0e3 * without);
    }
}

fn on_poles() {
    println!("turn,pole,ms_a_tick,times_without");
    for turn in 0..TURNS {
        let without = flag(Pole::None);
        for (name, pole) in [
            ("none", Pole::None),
            ("capsule", Pole::Capsule),
            ("cylinder", Pole::Cylinder),
        ] {
            let ms = flag(pole);
            println!("{turn},{name},{ms:.3},{:.2}", ms / without);
        }
    }
}

fn pressed() {
    println!(
        "radius_over_spacing,test,deepest_triangle_percent_of_radius,fallen_through,us_a_substep,candidates"
    );
    for ratio in [0.3, 0.5, 0.7, 0.8, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0] {
        for narrow_phase in [NarrowPhase::Particles, NarrowPhase::Triangles] {
            let pressed = press(ratio * SPACING, narrow_phase);
            let substeps = pressed.responses.len() as f64 * f64::from(TickStep::default().substeps);
            let seconds = pressed.responses.iter().sum::<f64>() / substeps;
            println!(
                "{ratio},{},{:.2},{},{:.2},{}",
                if narrow_phase == NarrowPhase::Particles {
                    "particles"
                } else {
                    "triangles"
                },
                100.0 * pressed.deepest / (ratio * SPACING),
                pressed.deepest >= ratio * SPACING,
                1.0e6 * seconds,
                pressed.candidates,
            );
        }
    }
}
