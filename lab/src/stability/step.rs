//! Time step against stiffness: where each method stays stable, and the theoretical limit of explicit steps.

use super::{
    Job, Map, Row, by,
    cloth::{Moving, Way, energy_at_start},
    ensure, largest,
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series, number},
    methods::{MassSpring, Scene, largest_frequency},
};

pub const STEP_STIFFNESS: Map = Map {
    name: "step_stiffness",
    columns: "x: time step (s), y: stiffness of the springs (N/m), measure: largest kinetic and potential energy over the start's as a part of the swing's, also: largest stretch; limit: x is 2/ω, measure ω (rad/s); 9 × 9 particles, 1 m wide, hung by the top row and let go 1 rad aside, undamped, 1 s",
    jobs,
    check,
    findings,
};

const EXPLICIT: &str = "explicit forces";
const OURS: &str = "bevy_drape";
const NEAR: &str = "explicit forces, near the limit";
const LIMIT: &str = "2/ω";
const FORCES: &str = "bevy_drape, forces below";

/// What a method takes a step with.
const WAYS: [(&str, fn() -> Way); 5] = [
    (EXPLICIT, || Way::explicit(1)),
    ("position-based, 10 sweeps", || Way::position_based(10)),
    ("small steps, 1 sweep", || Way::small_steps(1)),
    ("projective dynamics, 10", || Way::projective(10)),
    (OURS, || Way::ours(1)),
];

const STABLE: &str = "stable";
const RINGING: &str = "ringing";
const BLOWN_UP: &str = "blown up";

/// What a run with more energy than it began with is called.
///
/// Springs begin at rest, so their energy can only be more: kinetic and potential energy without theirs may never exceed
/// the start's, whatever the stiffness. What exceeds it is error; an undamped step of second order wavers by (ω Δt)²/24
/// of it for the modes that it resolves, some per cent at the coarsest steps here: 5 % is called stable. An unstable
/// mode grows by a factor in each step, so it passes any bound within few steps more: ten times the swing's energy is
/// no swing.
fn outcome(excess: f64) -> &'static str {
    match excess {
        ..=0.05 => STABLE,
        ..=10.0 => RINGING,
        _ => BLOWN_UP,
    }
}

fn scene(stiffness: f64) -> Scene {
    Scene::swinging(9, 1.0, 1.0, (1.0 / stiffness) as f32).expect("a valid scene")
}

fn limit(scene: &Scene) -> f64 {
    2.0 / largest_frequency(&MassSpring::of_scene(scene).expect("a valid network"))
}

/// The longest sub-step in which our springs push by their forces (s).
fn forces_below(scene: &Scene) -> f64 {
    let solver = scene.solver(false);
    solver.longest_explicit_substep(&scene.particles).into()
}

fn cell(name: &str, way: Way, step: f64, stiffness: f64) -> Row {
    let scene = scene(stiffness);
    let [start, swing] = energy_at_start(&scene);
    let mut moving = Moving::new(&scene, way, step);
    let (mut excess, mut stretch) = (0.0, 0.0);
    for _ in 0..(1.0 / step).round() as u32 {
        moving.step();
        excess = largest([excess, (moving.energy() - start) / swing]);
        stretch = largest([stretch, moving.stretch()]);
        // It will not come back.
        if excess.is_nan() || excess > 1.0e6 {
            break;
        }
    }
    Row::new(&STEP_STIFFNESS, name, [step, stiffness]).found(outcome(excess), excess, stretch)
}

/// 1, 2 and 5 times powers of ten.
fn steps(quick: bool) -> Vec<f64> {
    let all = [
        1.0e-4, 2.0e-4, 5.0e-4, 1.0e-3, 2.0e-3, 5.0e-3, 1.0e-2, 2.0e-2, 5.0e-2, 0.1,
    ];
    let keep = |index: &usize| !quick || [3, 5, 7].contains(index);
    (0..all.len())
        .filter(keep)
        .map(|index| all[index])
        .collect()
}

fn jobs(quick: bool) -> Vec<Job> {
    let powers = (2..=12).map(|half| 10f64.powf(f64::from(half) / 2.0));
    let stiffnesses: Vec<f64> = powers.collect();
    let every = if quick { 5 } else { 1 };
    let mut jobs: Vec<Job> = Vec::new();
    for stiffness in stiffnesses.into_iter().step_by(every) {
        jobs.push(Box::new(move || {
            let limit = limit(&scene(stiffness));
            let row = Row::new(&STEP_STIFFNESS, LIMIT, [limit, stiffness]);
            let mut rows = vec![row.found("limit", 2.0 / limit, 0.0)];
            let forces = forces_below(&scene(stiffness));
            let row = Row::new(&STEP_STIFFNESS, FORCES, [forces, stiffness]);
            rows.push(row.found("limit", 2.0 / forces, 0.0));
            for part in [0.9, 1.1] {
                rows.push(cell(NEAR, Way::explicit(1), part * limit, stiffness));
            }
            rows
        }));
        for (name, way) in WAYS {
            for step in steps(quick) {
                jobs.push(Box::new(move || vec![cell(name, way(), step, stiffness)]));
            }
        }
    }
    jobs
}

/// The step of the limit at a stiffness (s).
fn limit_at(rows: &[Row], stiffness: f64) -> f64 {
    let limits = by(rows, LIMIT);
    let limit = limits
        .iter()
        .find(|row| (row.y / stiffness - 1.0).abs() < 1e-6);
    limit.map_or(f64::NAN, |row| row.x)
}

fn check(rows: &[Row]) -> Result<(), String> {
    for row in rows.iter().filter(|row| row.method.starts_with(EXPLICIT)) {
        let part = row.x / limit_at(rows, row.y);
        let is_right = if part < 0.95 {
            row.outcome == STABLE
        } else {
            part < 1.05 || row.outcome == BLOWN_UP
        };
        ensure(is_right, || {
            format!(
                "explicit at {part:.2} × the limit, {} N/m: {}",
                row.y, row.outcome
            )
        })?;
    }
    for row in by(rows, OURS) {
        ensure(row.outcome != BLOWN_UP, || {
            format!("ours blown up at {} s, {} N/m", row.x, row.y)
        })?;
    }
    Ok(())
}

/// How many of a method's cells had an outcome, and how many there are.
fn count(rows: &[Row], method: &str, outcome: &str) -> (usize, usize) {
    let rows = by(rows, method);
    let found = rows.iter().filter(|row| row.outcome == outcome);
    (found.count(), rows.len())
}

fn findings(rows: &[Row]) -> Vec<String> {
    let near = by(rows, NEAR).len() / 2;
    let mut others = Vec::new();
    for (name, _) in WAYS {
        let (stable, all) = count(rows, name, STABLE);
        let (ringing, _) = count(rows, name, RINGING);
        let (blown_up, _) = count(rows, name, BLOWN_UP);
        let part = |count: usize| 100.0 * count as f64 / all as f64;
        others.push(format!(
            "{name} {:.0} % stable, {:.0} % ringing, {:.0} % blown up",
            part(stable),
            part(ringing),
            part(blown_up)
        ));
    }
    let excess = largest(by(rows, OURS).iter().map(|row| row.measure));
    vec![
        format!(
            "Explicit steps blow up where theory says: stable at 0.9 × 2/ω and blown up at 1.1 × at each of {near} stiffnesses over {:.0} decades.",
            (largest(rows.iter().map(|row| row.y))
                / rows.iter().map(|row| row.y).fold(f64::INFINITY, f64::min))
            .log10()
        ),
        format!("Time step against stiffness: {}.", others.join("; ")),
        if excess < 5.0e-4 {
            "Ours, one sub-step a step, never has more energy than it began with.".into()
        } else {
            format!(
                "Ours, one sub-step a step, has at most {:.1} % more energy than it began with.",
                100.0 * excess
            )
        },
    ]
}

pub fn chart(rows: &[Row]) -> Chart {
    let looks = [
        (STABLE, Look::Style(2)),
        (RINGING, Look::Style(4)),
        (BLOWN_UP, Look::Style(1)),
    ];
    let (explicit, all) = count(rows, EXPLICIT, BLOWN_UP);
    let blown_up: usize = WAYS[1..]
        .iter()
        .map(|(name, _)| count(rows, name, BLOWN_UP).0)
        .sum();
    let mut chart = Chart::new(
        "stability",
        format!(
            "Explicit springs blow up in {:.0} % of the map, beyond their limit 2/ω; {}",
            100.0 * explicit as f64 / all as f64,
            if blown_up == 0 {
                "the others never do".into()
            } else {
                format!("the others in {blown_up} cells")
            }
        ),
        "A cloth of 9 × 9 particles swings for 1 s, undamped. Energy beyond the start's, as a part of the swing's: stable up to 5 %, blown up beyond 10 ×. Stable does not mean exact: the last panel shows what stretch is left.",
    )
    .sized([960, 780])
    .columns(3);
    for (name, _) in WAYS {
        let mut panel = Panel::new(
            name,
            Axis::log("time step, ms"),
            Axis::log("stiffness, N/m"),
        );
        for (outcome, look) in looks {
            let cells = by(rows, name)
                .into_iter()
                .filter(|row| row.outcome == outcome);
            let cells = cells.map(|row| [1.0e3 * row.x, row.y]);
            panel = panel.with(Series::new(outcome, look, Kind::Cells, cells));
        }
        let [low, high] = range(by(rows, name).iter().map(|row| row.x));
        panel.x = panel.x.between(1.0e3 * low, 1.0e3 * high);
        let [low, high] = range(by(rows, name).iter().map(|row| row.y));
        panel.y = panel.y.between(low, high);
        if name == OURS {
            let border = by(rows, FORCES).into_iter();
            let border = border.map(|row| [1.0e3 * row.x, row.y]);
            let label = "forces to the left, threads to the right";
            panel = panel.with(Series::new(label, Look::Ink, Kind::Line, border));
        }
        if name == EXPLICIT {
            let limit = by(rows, LIMIT)
                .into_iter()
                .map(|row| [1.0e3 * row.x, row.y]);
            panel = panel.with(Series::new(
                "theoretical limit 2/ω",
                Look::Ink,
                Kind::Line,
                limit,
            ));
        }
        chart = chart.with(panel);
    }
    let stiffest = largest(rows.iter().map(|row| row.y));
    let mut panel = Panel::new(
        format!("stretch at {} N/m", number(stiffest)),
        Axis::log("time step, ms"),
        Axis::log("largest stretch, %").between(1.0e-4, 1.0e3),
    );
    for (style, (name, _)) in WAYS.into_iter().enumerate().skip(1) {
        let cells = by(rows, name).into_iter();
        let cells = cells.filter(|row| row.y == stiffest && row.outcome != BLOWN_UP);
        let points = cells.map(|row| [1.0e3 * row.x, 100.0 * row.also]);
        panel = panel.with(Series::new(
            name,
            Look::Style([7, 0, 3, 5, 6][style]),
            Kind::Marked,
            points,
        ));
    }
    chart.with(panel)
}

/// Ends with half a cell of room.
fn range(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    [low / 1.6, largest(values) * 1.6]
}
