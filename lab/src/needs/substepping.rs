//! A fixed number of sub-steps, or as few as hold a tolerance.

use bevy::math::Vec3;
use bevy_drape::solver::{Control, Stretch, Substepping};

use super::{Row, STRETCH};
use crate::{experiment::Run, measure::seconds, methods::Scene};

pub const SCENE: &str = "fall, calm, gust, 32²";

/// Names, and the largest stretch.
pub const TOLERANCES: [(&str, f32); 3] = [
    ("tolerance 5 %", 0.05),
    ("tolerance 2 %", 0.02),
    ("tolerance 1 %", 0.01),
];

const FIXED: [(&str, u32); 4] = [
    ("5 sub-steps", 5),
    ("10 sub-steps", 10),
    ("20 sub-steps", 20),
    ("40 sub-steps", 40),
];

/// More than any tick should need.
const MAX: u32 = 400;

/// Ticks of the scene: it falls, swings out, hangs calm, and a gust comes.
const TICKS: u32 = 480;
const GUST: std::ops::Range<u32> = 360..375;

pub fn measure(run: &mut Run) -> Vec<Row> {
    let turns = run.either(2, 15);
    run.set("precision", format!("32² rigid threads, 2 m wide, fall from the horizontal by two corners, damping 0.05, and after 6 s a gust of 3 g for a quarter second; the mean of 8 s at 60 ticks a second, {turns} turns"));
    let fixed = FIXED.map(|(name, substeps)| (name, Substepping::Fixed(substeps)));
    let held = TOLERANCES.map(|(name, stretch)| {
        let max_substeps = MAX;
        (
            name,
            Substepping::Adaptive {
                stretch,
                max_substeps,
            },
        )
    });
    let mut choices: Vec<_> = fixed
        .into_iter()
        .chain(held)
        .map(|(name, substepping)| (name, substepping, Vec::new(), 0.0))
        .collect();
    for _ in 0..turns {
        for (_, substepping, ms, largest) in &mut choices {
            let (seconds, stretch) = play(*substepping);
            ms.push(1.0e3 * seconds / f64::from(TICKS));
            *largest = stretch;
        }
    }
    choices
        .iter()
        .map(|(name, _, ms, stretch)| Row::new(SCENE, name, ms, (f64::from(*stretch), STRETCH)))
        .collect()
}

/// Time of the whole scene (s), and the largest stretch that any tick ended with.
fn play(substepping: Substepping) -> (f64, f32) {
    let mut scene = Scene::hung_by_corners(32, 2.0).expect("a valid scene");
    scene.material.damping = 0.05;
    let mut solver = scene.solver(false);
    let mut particles = scene.particles.clone();
    let mut before = particles.clone();
    let mut control = Control::default();
    let mut largest = 0.0_f32;
    let time = seconds(|| {
        for tick in 0..TICKS {
            let along = scene.surface.particles_along();
            let needed = solver.needed(&particles, along, scene.seconds, scene.step(1).order);
            let mut substeps = control.substeps(substepping, needed);
            if matches!(substepping, Substepping::Adaptive { .. }) {
                before.clone_from(&particles);
            }
            let stretch: Stretch = loop {
                let mut step = scene.step(substeps);
                if GUST.contains(&tick) {
                    step.acceleration += Vec3::new(0.5, 0.0, 1.0).normalize() * 3.0 * 9.81;
                }
                let stretch = solver.advance(&mut particles, step, &[], |_, _| false);
                match control.observe(substepping, stretch) {
                    Some(more) => {
                        substeps = more;
                        particles.clone_from(&before);
                    }
                    None => break stretch,
                }
            };
            largest = largest.max(stretch.structural);
        }
    });
    (time, largest)
}
