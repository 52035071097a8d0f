//! The paper's D from 0 to 1: what it takes in a second, whether anything gains energy, and from where on it depends on
//! the sub-steps.

use bevy::math::Vec3;

use super::{
    Job, Map, Row, by,
    cloth::{Moving, Way, energy_at_start},
    ensure, largest, values,
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series, number},
    methods::{GRAVITY, Scene},
};

pub const DAMPING: Map = Map {
    name: "damping",
    columns: "x: D, measure: part of its speed that a free cloth keeps after 1 s less the closed form (1 − D)⁶⁰, also: largest kinetic and potential energy of a swing over the start's as a part of the swing's; 9 × 9 particles, 1 m wide, 10⁻³ m/N, 60 ticks a second",
    jobs: kept_jobs,
    check: kept_check,
    findings: kept_findings,
};

pub const FALLING: Map = Map {
    name: "falling",
    columns: "x: D, y: sub-steps in 1/60 s, measure: speed of a fall after 1 s over the closed form g (1 − e⁻ᶜᵗ)/c with c = −60 ln(1 − D), − 1, also: that closed form (m/s)",
    jobs: fall_jobs,
    check: fall_check,
    findings: fall_findings,
};

const OURS: &str = "bevy_drape, 20 sub-steps";

const WAYS: [(&str, fn() -> Way); 5] = [
    ("explicit forces, 40 steps", || Way::explicit(40)),
    ("position-based, 10 sweeps", || Way::position_based(10)),
    ("small steps, 20", || Way::small_steps(20)),
    ("projective dynamics, 10", || Way::projective(10)),
    (OURS, || Way::ours(20)),
];

/// Largest difference from the closed form: 1200 products in f32 are off by 1200 × 6·10⁻⁸ at most, and a displacement is half
/// a sub-step older than its end.
const ROUNDING: f64 = 2.0e-3;

fn swing(damping: f32) -> Scene {
    let mut scene = Scene::swinging(9, 1.0, 1.0, 1.0e-3).expect("a valid scene");
    scene.material.damping = damping;
    scene
}

/// The same without pins and gravity, or with gravity, at a speed (m/s) along x.
fn free(damping: f32, speed: f32) -> Scene {
    let mut scene = swing(damping);
    scene.acceleration = Vec3::ZERO;
    for index in 0..scene.particles.len() {
        let w = scene.particles.inverse_mass(40).expect("the middle one");
        scene
            .particles
            .set_inverse_mass(index, w)
            .and_then(|()| scene.particles.set_velocity(index, Vec3::X * speed))
            .expect("it exists");
    }
    scene
}

fn kept(name: &str, way: Way, damping: f32) -> Row {
    let scene = free(damping, 1.0);
    let mut moving = Moving::new(&scene, way, scene.seconds.into());
    for _ in 0..60 {
        moving.step();
    }
    let kept = moving.mean_velocity().x - (1.0 - f64::from(damping)).powi(60);
    let scene = swing(damping);
    let [start, swing] = energy_at_start(&scene);
    let mut moving = Moving::new(&scene, way, scene.seconds.into());
    let mut excess = 0.0;
    for _ in 0..60 {
        moving.step();
        excess = largest([excess, (moving.energy() - start) / swing]);
    }
    let outcome = match (kept.abs() <= ROUNDING, excess <= 0.05) {
        (true, true) => "as given",
        (false, true) => "other than given",
        _ => "gains energy",
    };
    Row::new(&DAMPING, name, [number_of(damping), 0.0]).found(outcome, kept, excess)
}

/// As it was written, not as f32 holds it.
fn number_of(value: f32) -> f64 {
    (f64::from(value) * 1.0e6).round() / 1.0e6
}

fn kept_jobs(quick: bool) -> Vec<Job> {
    let all = [
        0.0, 0.001, 0.01, 0.02, 0.03, 0.05, 0.075, 0.1, 0.125, 0.15, 0.2, 0.5, 0.8, 0.95, 0.99, 1.0,
    ];
    let every = if quick { 4 } else { 1 };
    let mut jobs: Vec<Job> = Vec::new();
    for (name, way) in WAYS {
        for damping in all.into_iter().step_by(every).chain(quick.then_some(1.0)) {
            jobs.push(Box::new(move || vec![kept(name, way(), damping)]));
        }
    }
    jobs
}

fn kept_check(rows: &[Row]) -> Result<(), String> {
    for row in rows {
        ensure(row.outcome == "as given", || {
            format!(
                "{} at D = {}: {} ({}, {})",
                row.method, row.x, row.outcome, row.measure, row.also
            )
        })?;
    }
    Ok(())
}

fn kept_findings(rows: &[Row]) -> Vec<String> {
    let off = largest(rows.iter().map(|row| row.measure.abs()));
    let gained = rows.iter().filter(|row| row.also >= 5.0e-4);
    let excess = gained.max_by(|a, b| a.also.total_cmp(&b.also));
    let excess = excess.map_or("no more than its start".into(), |row| {
        format!(
            "{:.1} % more than its start ({} at D = {})",
            100.0 * row.also,
            row.method,
            row.x
        )
    });
    vec![format!(
        "From D = 0 to 1 every method keeps the part (1 − D)^60 of its speed in a second, within {}; the energy of a swing is {excess}.",
        number((1.0e7 * off).ceil() / 1.0e7)
    )]
}

fn fall(damping: f64, substeps: u32) -> Row {
    let mut scene = free(damping as f32, 0.0);
    scene.acceleration = GRAVITY;
    let mut moving = Moving::new(&scene, Way::ours(substeps), scene.seconds.into());
    for _ in 0..60 {
        moving.step();
    }
    let rate = -60.0 * (1.0 - damping).ln();
    let gravity = f64::from(scene.acceleration.length());
    let exact = if rate > 0.0 {
        gravity * (1.0 - (-rate).exp()) / rate
    } else {
        gravity
    };
    let off = -moving.mean_velocity().y / exact - 1.0;
    let outcome = match off.abs() {
        ..=0.01 => "as derived",
        ..=0.1 => "near",
        _ => "by the sub-steps",
    };
    Row::new(
        &FALLING,
        format!("{substeps} sub-steps"),
        [damping, substeps.into()],
    )
    .found(outcome, off, exact)
}

const SUBSTEPS: [u32; 3] = [5, 20, 80];

fn fall_jobs(quick: bool) -> Vec<Job> {
    let all = [
        0.0, 0.01, 0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999,
    ];
    let every = if quick { 6 } else { 1 };
    let mut jobs: Vec<Job> = Vec::new();
    for substeps in SUBSTEPS {
        for damping in all.into_iter().step_by(every) {
            jobs.push(Box::new(move || vec![fall(damping, substeps)]));
        }
    }
    jobs
}

/// With u = −ln(1 − D)/n for n sub-steps, a sub-step's fall ends at g Δt/(1 − e⁻ᵘ) where the closed form is g Δt/u: more
/// by u/2 and a twelfth of its square.
fn derived(damping: f64, substeps: f64) -> f64 {
    let u = -(1.0 - damping).ln() / substeps;
    if u > 0.0 {
        u / (1.0 - (-u).exp()) - 1.0
    } else {
        0.0
    }
}

fn fall_check(rows: &[Row]) -> Result<(), String> {
    for row in rows {
        let derived = derived(row.x, row.y);
        ensure(
            // Of first order that is what it is; of second order it is between that and none, but for what a displacement is
            // older than the end of its sub-step.
            row.measure < 1.02 * derived + 1.0e-3 && row.measure > -0.5 / 60.0 / row.y - 1.0e-3,
            || {
                format!(
                    "D = {}, {} sub-steps: {} where {derived} is derived",
                    row.x, row.y, row.measure
                )
            },
        )?;
    }
    Ok(())
}

fn fall_findings(rows: &[Row]) -> Vec<String> {
    // A fall is too fast by u ⁄ (1 − e^−u), which is 1.1 at u = 0.194.
    let to = |substeps: u32| 1.0 - (-0.194 * f64::from(substeps)).exp();
    let worst = largest(
        rows.iter()
            .filter(|row| row.y == 20.0)
            .map(|row| row.measure),
    );
    vec![format!(
        "A damped fall is faster than its closed form by half of −ln(1 − D)/n, n being the sub-steps in 1/60 s: within 10 % up to D = {:.2} with 5, {:.2} with 20; by {:.0} % at D = {} with 20.",
        to(5),
        to(20),
        100.0 * worst,
        largest(rows.iter().map(|row| row.x)),
    )]
}

pub fn chart(kept: &[Row], falls: &[Row]) -> Chart {
    let mut speeds = Panel::new(
        "Speed that is left after 1 s",
        Axis::linear("damping D").between(-0.005, 0.19),
        Axis::log("speed left, %").between(1.0e-3, 200.0),
    );
    let exact = (0..=200).map(|index| f64::from(index) / 1000.0);
    let exact = exact.map(|damping| [damping, 100.0 * (1.0 - damping).powi(60)]);
    speeds = speeds.with(Series::new("closed form", Look::Ink, Kind::Line, exact));
    for (style, (name, _)) in WAYS.into_iter().enumerate() {
        let points = by(kept, name).into_iter();
        let points = points.map(|row| [row.x, 100.0 * ((1.0 - row.x).powi(60) + row.measure)]);
        speeds = speeds.with(Series::new(name, Look::Style(style), Kind::Points, points));
    }
    let mut fall = Panel::new(
        "Fall, against its closed form",
        Axis::linear("damping D"),
        Axis::log("faster by, %").between(0.01, 100.0),
    );
    for (style, substeps) in values(falls, |row| row.y).into_iter().enumerate() {
        let points = falls.iter().filter(|row| row.y == substeps && row.x > 0.0);
        let points = points.map(|row| [row.x, 100.0 * row.measure]);
        let name = format!("falls in {substeps} sub-steps");
        fall = fall.with(Series::new(
            name,
            Look::Style(style + 5),
            Kind::Marked,
            points,
        ));
    }
    let excess = largest(kept.iter().map(|row| row.also));
    Chart::new(
        "stability-damping",
        if excess < 5.0e-4 {
            "D means the same by every method, from 0 to 1, and none gains energy".into()
        } else {
            format!("D means the same by every method, and none gains more than {:.1} % of energy", 100.0 * excess)
        },
        "A free cloth of 9 × 9 particles. Left: without gravity, by every method. Right: falling, by bevy_drape, in so many sub-steps in 1/60 s: its end speed depends on them where D is near 1.",
    )
    .sized([960, 500])
    .columns(2)
    .with(speeds)
    .with(fall)
}
