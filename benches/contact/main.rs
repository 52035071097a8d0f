//! Particles or triangles? `cargo bench --profile dev --bench contact`, as CSV.
//!
//! A ball is pressed six spacings deep into the middle of a cell of a cloth that is held by its rim, and held there. How
//! deep the flat triangles then are inside of the ball, and what a sub-step's response takes, by either narrow phase.

mod press;

use bevy_drape::{contact::NarrowPhase, solver::TickStep};
use press::{SPACING, press};

fn main() {
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
