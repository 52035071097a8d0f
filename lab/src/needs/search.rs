//! How cloths are searched, and what colliders are tested against.

use bevy_drape::{
    contact::NarrowPhase,
    hierarchy::{BoundRule, BoundingVolume, NodeBounds, TopDownQuery, brute_force},
};

use super::{
    DEPTH, Row, WRONG,
    press::{SPACING, press},
};
use crate::{
    cloths::Choice, draped::Draped, exactness::missed_and_false, experiment::Run,
    measure::seconds_each,
};

pub const SCAN: &str = "scan";
pub const REST_SHAPE: &str = "spheres, rest shape";
pub const REFIT: &str = "AABBs, refit";

const SEARCHES: [(&str, Option<Choice>); 3] = [
    (SCAN, None),
    (
        REST_SHAPE,
        Some((BoundingVolume::Sphere, BoundRule::RestShape)),
    ),
    (REFIT, Some((BoundingVolume::Aabb, BoundRule::Refit))),
];

/// Cloths and balls, by name.
pub const SCENES: [(&str, u32, u32); 6] = [
    ("16², 1 ball", 16, 1),
    ("16², 100 balls", 16, 100),
    ("64², 1 ball", 64, 1),
    ("64², 100 balls", 64, 100),
    ("256², 1 ball", 256, 1),
    ("256², 100 balls", 256, 100),
];

/// Trees against a scan of all particles.
pub fn trees(run: &mut Run) -> Vec<Row> {
    let turns = run.either(5, 61);
    run.set("tree against scan", format!("a draped cloth and balls of 4 spacings all over it: rebuild and all queries of a tick, {turns} turns"));
    let mut rows = Vec::new();
    let mut query = TopDownQuery::default();
    for (scene, side, balls) in SCENES {
        let draped = Draped::new(side);
        let balls = if balls == 1 {
            vec![draped.ball()]
        } else {
            draped.balls(balls)
        };
        let truth: Vec<Vec<u32>> = balls
            .iter()
            .map(|ball| brute_force(&draped.particles, ball))
            .collect();
        let mut bounds = NodeBounds::default();
        let mut ms = [const { Vec::new() }; SEARCHES.len()];
        let mut wrong = [0; SEARCHES.len()];
        for _ in 0..turns {
            for (at, (_, choice)) in SEARCHES.into_iter().enumerate() {
                let mut ends = Vec::new();
                ms[at].push(
                    1.0e3
                        * seconds_each(2.0e-4, || {
                            query.clear();
                            ends.clear();
                            if let Some(choice) = choice {
                                draped.rebuild(&mut bounds, choice);
                            }
                            for ball in &balls {
                                ends.push(match choice {
                                    Some(_) => {
                                        query.search(&draped.tree, &bounds, &draped.particles, ball)
                                    }
                                    None => query.scan(&draped.particles, ball),
                                });
                            }
                        }),
                );
                let all = truth.iter().zip(&ends);
                let wrongs = all.map(|(truth, found)| {
                    let found = &query.candidates()[found.clone()];
                    missed_and_false(found, truth).iter().sum::<usize>()
                });
                wrong[at] = wrongs.sum::<usize>().max(wrong[at]);
            }
        }
        for ((choice, _), (ms, wrong)) in SEARCHES.into_iter().zip(ms.iter().zip(wrong)) {
            rows.push(Row::new(scene, choice, ms, (wrong as f64, WRONG)));
        }
    }
    rows
}

pub const PARTICLES: &str = "particles";
pub const TRIANGLES: &str = "triangles";

/// Balls by name, and their radii in spacings.
pub const BALLS: [(&str, f32); 3] = [
    ("ball of 1 spacing", 1.0),
    ("ball of 3 spacings", 3.0),
    ("ball of 8 spacings", 8.0),
];

/// Particles against triangles.
pub fn narrow_phases(run: &mut Run) -> Vec<Row> {
    let turns = run.either(1, 7);
    run.set("particles against triangles", format!("a ball pressed into a cloth of 33² that its rim holds: the response of a tick's 20 sub-steps while it is held there, {turns} turns"));
    let mut rows = Vec::new();
    for (scene, radius) in BALLS {
        let mut ms = [const { Vec::new() }; 2];
        let mut depth = [0.0; 2];
        for _ in 0..turns {
            let phases = [NarrowPhase::Particles, NarrowPhase::Triangles];
            for (at, narrow_phase) in phases.into_iter().enumerate() {
                let pressed = press(radius * SPACING, narrow_phase);
                let fell_through = pressed.deepest >= radius * SPACING;
                assert!(
                    fell_through || pressed.candidates > 0,
                    "the ball is at the cloth"
                );
                // It has stood still for a quarter of all ticks.
                let held = &pressed.responses[pressed.responses.len() * 3 / 4..];
                ms[at].extend(held.iter().map(|seconds| 1.0e3 * seconds));
                depth[at] = f64::from(pressed.deepest / (radius * SPACING)).max(0.0);
            }
        }
        let choices = [PARTICLES, TRIANGLES].into_iter();
        for (choice, (ms, depth)) in choices.zip(ms.iter().zip(depth)) {
            rows.push(Row::new(scene, choice, ms, (depth, DEPTH)));
        }
    }
    rows
}
