//! Ball speed against its size in spacings: how many shots get through, by the test at the ends of sub-steps and by
//! that all along the way.

/// What `shots` calls the library, whose own tests read it, too.
use bevy_drape as library;

#[path = "../../../src/contact/tests/shots.rs"]
mod shots;

use bevy::math::Vec3;
use shots::{SPACING, SUBSTEPS_A_SECOND, Shot};

use super::{Job, Map, Row, by, ensure, values};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series, number},
    measure::Random,
};

pub const TUNNELLING: Map = Map {
    name: "tunnelling",
    columns: "x: speed of the ball (m/s), y: its radius in spacings, measure: part of the shots that got through, also: way in a sub-step in radii; free cloth of 16 × 16 particles, 0.1 m apart, 60 ticks of 20 sub-steps a second",
    jobs,
    check,
    findings,
};

const DISCRETE: &str = "ends of sub-steps";
const SWEPT: &str = "all along the way";
/// Radius of the smallest balls (spacings) that the cloth is meant for; a smaller one may slip through where it parts the
/// particles.
const SMALLEST: f64 = 0.5;
/// Speed (m/s) up to which none of the others does: 3.3 spacings in a sub-step.
const FASTEST: f64 = 400.0;

const STOPPED: &str = "stopped";
const SOME: &str = "some through";
const ALL: &str = "all through";

fn cell(is_swept: bool, speed: f32, ratio: f32, shots: u64) -> Row {
    let radius = ratio * SPACING;
    let through = (0..shots).filter(|&seed| {
        let mut random = Random(seed);
        let shot = Shot {
            speed,
            radius,
            is_swept,
            beside: [random.between(-1.0, 1.0), random.between(-1.0, 1.0)],
            delay: random.part(),
            direction: Vec3::Z,
            spin: Vec3::from_array([0; 3].map(|_| random.between(-30.0, 30.0))),
        };
        shot.through().is_some()
    });
    let part = through.count() as f64 / shots as f64;
    let outcome = match part {
        0.0 => STOPPED,
        1.0 => ALL,
        _ => SOME,
    };
    let way = speed / SUBSTEPS_A_SECOND / radius;
    Row::new(
        &TUNNELLING,
        if is_swept { SWEPT } else { DISCRETE },
        [speed.into(), ratio.into()],
    )
    .found(outcome, part, way.into())
}

fn jobs(quick: bool) -> Vec<Job> {
    let speeds: &[f32] = if quick {
        &[25.0, 200.0]
    } else {
        &[10.0, 25.0, 50.0, 100.0, 200.0, 400.0, 800.0]
    };
    let ratios: &[f32] = if quick {
        &[0.5, 2.0]
    } else {
        &[0.25, 0.5, 1.0, 2.0, 4.0]
    };
    let shots = if quick { 3 } else { 12 };
    let mut jobs: Vec<Job> = Vec::new();
    for is_swept in [false, true] {
        for &speed in speeds {
            for &ratio in ratios {
                jobs.push(Box::new(move || vec![cell(is_swept, speed, ratio, shots)]));
            }
        }
    }
    jobs
}

fn check(rows: &[Row]) -> Result<(), String> {
    for row in by(rows, SWEPT) {
        ensure(
            row.measure == 0.0 || row.y < SMALLEST || row.x > FASTEST,
            || format!("{} m/s, {} spacings got through", row.x, row.y),
        )?;
    }
    ensure(
        by(rows, DISCRETE).iter().any(|row| row.measure > 0.0),
        || "there is something to be swept for".into(),
    )
}

/// The slowest ball, by its way in a sub-step (radii), that gets through the discrete test.
fn slowest(rows: &[Row]) -> f64 {
    let through = by(rows, DISCRETE)
        .into_iter()
        .filter(|row| row.measure > 0.0);
    through.map(|row| row.also).fold(f64::INFINITY, f64::min)
}

/// Balls that got through all the same: speed (m/s), radius (spacings) and part of the shots.
fn leaks(rows: &[Row]) -> String {
    let mut through = by(rows, SWEPT);
    through.retain(|row| row.measure > 0.0);
    let each = through.iter().map(|row| {
        let part = 100.0 * row.measure;
        format!(
            "{part:.0} % of those of {} spacings at {} m/s",
            row.y, row.x
        )
    });
    match each.collect::<Vec<_>>() {
        none if none.is_empty() => "and no other".into(),
        leaks => format!("but {}", leaks.join(" and ")),
    }
}

/// The highest speed up to which no ball gets through that the cloth is meant for (m/s).
fn safe(rows: &[Row]) -> f64 {
    let swept = by(rows, SWEPT);
    let through = swept
        .iter()
        .filter(|row| row.measure > 0.0 && row.y >= SMALLEST);
    let slowest = through.map(|row| row.x).fold(f64::INFINITY, f64::min);
    let below = swept
        .iter()
        .map(|row| row.x)
        .filter(|speed| *speed < slowest);
    below.fold(0.0, f64::max)
}

fn findings(rows: &[Row]) -> Vec<String> {
    let discrete = by(rows, DISCRETE);
    let through: f64 = discrete.iter().map(|row| row.measure).sum();
    vec![format!(
        "Tested at the ends of sub-steps alone, {:.0} % of the balls get through, from a way of {:.2} radii in a sub-step on; tested all along it none of {SMALLEST} spacings or more does up to {:.0} m/s, {}.",
        100.0 * through / discrete.len() as f64,
        slowest(rows),
        safe(rows),
        leaks(rows)
    )]
}

pub fn chart(rows: &[Row]) -> Chart {
    let ratios = values(rows, |row| row.y);
    let mut chart = Chart::new(
        "stability-tunnelling",
        format!(
            "Tested all along its way, no ball of {SMALLEST} spacings or more gets through up to {:.0} m/s",
            safe(rows)
        ),
        "Balls shot at a free cloth, 0.1 m between particles, 20 sub-steps in 1/60 s: the part whose centre passes a triangle, by radius in spacings.",
    )
    .sized([960, 460])
    .columns(2);
    for (method, title) in [
        (DISCRETE, "Tested at the ends of sub-steps"),
        (SWEPT, "Tested all along the way"),
    ] {
        let mut panel = Panel::new(
            title,
            Axis::log("speed of the ball, m/s"),
            Axis::linear("got through, %").between(-5.0, 105.0),
        );
        for (style, &ratio) in ratios.iter().enumerate() {
            let cells = by(rows, method).into_iter().filter(|row| row.y == ratio);
            let points = cells.map(|row| [row.x, 100.0 * row.measure]);
            let name = format!("radius {} spacings", number(ratio));
            panel = panel.with(Series::new(name, Look::Style(style), Kind::Marked, points));
        }
        chart = chart.with(panel);
    }
    chart
}
