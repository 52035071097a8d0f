//! Heavy hems and heavy corners: how far a cloth stretches whose lower edge, or one particle of it, is heavier.

use super::{
    Job, Map, Row, between, by,
    cloth::{Moving, Way},
    ensure, largest, methods, outcome_of, percent, values,
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series, number},
    methods::Scene,
};

pub const MASS_RATIO: Map = Map {
    name: "mass_ratio",
    columns: "x: mass over that of the other particles, y: how many are so heavy (32: the lower edge, 1: its middle), measure: largest stretch of the last of 3 s, also: largest of all; 32 × 32 particles, 2 m wide, springs of 10⁶ N/m, hung by the top row, let go 0.5 rad aside",
    jobs,
    check,
    findings,
};

const SIDE: u32 = 32;
const TETHERED: &str = "with tethers, 20 sub-steps";
const PEER: &str = "position-based, 20 sweeps";
const FREE: &str = "bevy_drape, 20 sub-steps";

const WAYS: [(&str, fn() -> Way); 6] = [
    (TETHERED, || Way::tethered(20)),
    ("with tethers, 80 sub-steps", || Way::tethered(80)),
    (FREE, || Way::ours(20)),
    ("bevy_drape, 80 sub-steps", || Way::ours(80)),
    (PEER, || Way::position_based(20)),
    ("projective dynamics, 10", || Way::projective(10)),
];

fn cell(name: &str, way: Way, ratio: f32, is_edge: bool) -> Row {
    // So stiff that what stretches is the method's fault: 0.1 % are the material's own under the heaviest edge.
    let mut scene = Scene::swinging(SIDE, 2.0, 0.5, 1.0e-6).expect("a valid scene");
    scene.material.damping = 0.01;
    let columns = if is_edge {
        0..SIDE
    } else {
        SIDE / 2..SIDE / 2 + 1
    };
    for column in columns.clone() {
        let cell = (SIDE - 1, column);
        let w = scene.particles.inverse_mass(cell).expect("it exists");
        scene
            .particles
            .set_inverse_mass(cell, w / ratio)
            .expect("a valid mass");
    }
    let mut moving = Moving::new(&scene, way, scene.seconds.into());
    let (mut last_second, mut ever) = (0.0, 0.0);
    for tick in 0..180 {
        moving.step();
        ever = largest([ever, moving.stretch()]);
        if tick >= 120 {
            last_second = largest([last_second, moving.stretch()]);
        }
    }
    Row::new(&MASS_RATIO, name, [ratio.into(), columns.len() as f64]).found(
        outcome_of(last_second),
        last_second,
        ever,
    )
}

fn jobs(quick: bool) -> Vec<Job> {
    let ratios: &[f32] = if quick {
        &[1.0, 100.0, 1.0e4]
    } else {
        &[1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1.0e3, 3.0e3, 1.0e4]
    };
    let mut jobs: Vec<Job> = Vec::new();
    for is_edge in [true, false] {
        for (name, way) in WAYS {
            // The cheap ones.
            if quick && ![TETHERED, FREE, PEER].contains(&name) {
                continue;
            }
            for &ratio in ratios {
                jobs.push(Box::new(move || vec![cell(name, way(), ratio, is_edge)]));
            }
        }
    }
    jobs
}

fn at(rows: &[Row], method: &str, [ratio, heavy]: [f64; 2]) -> f64 {
    let cells = by(rows, method);
    let cell = cells.iter().find(|row| row.x == ratio && row.y == heavy);
    cell.map_or(f64::NAN, |row| row.measure)
}

fn check(rows: &[Row]) -> Result<(), String> {
    for row in rows.iter().filter(|row| row.method.contains("sub-steps")) {
        ensure(row.measure.is_finite(), || {
            format!("{} at {} is not finite", row.method, row.x)
        })?;
    }
    let heaviest = largest(rows.iter().map(|row| row.x));
    for heavy in [32.0, 1.0] {
        let [tethered, free] = [TETHERED, FREE].map(|way| at(rows, way, [heaviest, heavy]));
        ensure(tethered <= free, || {
            format!("tethers do harm at a ratio of {heaviest}: {tethered}, {free}")
        })?;
    }
    Ok(())
}

/// The largest ratio up to which a method holds within 5 %.
fn good_to(rows: &[Row], method: &str, heavy: f64) -> f64 {
    let mut cells = by(rows, method);
    cells.retain(|row| row.y == heavy);
    let held = cells.iter().take_while(|row| row.measure <= 0.05);
    held.map(|row| row.x).fold(0.0, f64::max)
}

fn findings(rows: &[Row]) -> Vec<String> {
    let heaviest = largest(rows.iter().map(|row| row.x));
    [(32.0, "the lower edge"), (1.0, "one particle")]
        .map(|(heavy, what)| {
            let each = methods(rows).into_iter().map(|name| {
                let to = match good_to(rows, name, heavy) {
                    0.0 => "never".into(),
                    ratio => format!("up to {}", number(ratio)),
                };
                format!(
                    "{name} {to} ({} at {})",
                    percent(at(rows, name, [heaviest, heavy])),
                    number(heaviest)
                )
            });
            format!(
                "With {what} so many times heavier a stretch of 5 % holds: {}.",
                each.collect::<Vec<_>>().join("; ")
            )
        })
        .to_vec()
}

pub fn chart(rows: &[Row]) -> Chart {
    /// The edges of the chart (%).
    const ENDS: [f64; 2] = [0.01, 1.0e4];
    let heaviest = largest(rows.iter().map(|row| row.x));
    let edge = |method| percent(at(rows, method, [heaviest, 32.0]));
    let mut chart = Chart::new(
        "stability-mass",
        format!(
            "A hem {} times as heavy stretches the cloth by {} with tethers, by {} without",
            number(heaviest),
            edge(TETHERED),
            edge(FREE)
        ),
        "Largest stretch in the third second, 32 × 32 particles, 2 m wide, springs of 10⁶ N/m, hung by the top row and let go 0.5 rad aside. What is above the edge is drawn on it.",
    )
    .sized([960, 520])
    .columns(2);
    for heavy in values(rows, |row| row.y).into_iter().rev() {
        let title = if heavy > 1.0 {
            "The lower edge is heavier"
        } else {
            "One particle is heavier"
        };
        let mut panel = Panel::new(
            title,
            Axis::log("times as heavy"),
            Axis::log("largest stretch, %").between(ENDS[0], ENDS[1]),
        );
        for (style, name) in methods(rows).into_iter().enumerate() {
            let cells = by(rows, name).into_iter().filter(|row| row.y == heavy);
            let points = cells.map(|row| [row.x, between(100.0 * row.measure, ENDS)]);
            panel = panel.with(Series::new(name, Look::Style(style), Kind::Marked, points));
        }
        chart = chart.with(panel);
    }
    chart
}
