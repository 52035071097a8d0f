//! The order in which springs are swept, against how few sweeps a sub-step has: one and the same number of sweeps.

use super::{
    Job, Map, Row, between, by,
    cloth::{Moving, Way},
    ensure, largest, outcome_of, percent, values,
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    measure::Random,
    methods::{GRAVITY, MassSpring, Method, Scene, Stepper},
};

pub const SWEEP_ORDER: Map = Map {
    name: "sweep_order",
    columns: "x: sweeps a sub-step, of 20 a tick, y: particles a side, measure: largest stretch of the last of 3 s, also: sub-steps a tick; rigid springs, 2 m wide, hung by two corners, 60 ticks a second, all in f32",
    jobs,
    check,
    findings,
};

const COLOURS: &str = "colour by colour";
const ROWS: &str = "row by row";
const ALTERNATING: &str = "rows, to and fro";
const SHUFFLED: &str = "shuffled";
const ORDERS: [&str; 4] = [COLOURS, ROWS, ALTERNATING, SHUFFLED];
const OURS: &str = "bevy_drape";
/// Sweeps in a tick.
const SWEEPS: u32 = 20;

fn scene(side: u32) -> Scene {
    Scene::hung_by_corners(side, 2.0).expect("a valid scene")
}

fn cell(order: &'static str, side: u32, sweeps: u32) -> Row {
    let scene = scene(side);
    let substeps = SWEEPS / sweeps;
    let mut network: MassSpring<f32> = MassSpring::of_scene(&scene).expect("a valid network");
    match order {
        // As a loop over the particles makes them: to the right, down, and along both diagonals.
        ROWS | ALTERNATING => network.springs.sort_by_key(|spring| {
            let [a, b] = spring.ends;
            let steps = [1, side, side + 1, side - 1];
            (
                a.min(b),
                steps.iter().position(|&step| step == a.abs_diff(b)),
            )
        }),
        SHUFFLED => {
            let mut random = Random(7);
            for last in (1..network.springs.len()).rev() {
                network
                    .springs
                    .swap(last, random.below(last as u32 + 1) as usize);
            }
        }
        _ => {}
    }
    let method = Method::PositionBased { iterations: sweeps };
    let dt = f64::from(scene.seconds) / f64::from(substeps);
    let mut stepper = Stepper::new(method, &network, dt).expect("a method for it");
    let mut stretch = 0.0;
    for tick in 0..180 {
        for _ in 0..substeps {
            stepper.step(&mut network, GRAVITY.to_array(), scene.material.damping);
            if order == ALTERNATING {
                // All springs are rigid, so that the stepper remembers nothing of them.
                network.springs.reverse();
            }
        }
        if tick >= 120 {
            stretch = largest([stretch, network.largest_stretch()]);
        }
    }
    Row::new(&SWEEP_ORDER, order, [sweeps.into(), side.into()]).found(
        outcome_of(stretch),
        stretch,
        substeps.into(),
    )
}

fn ours(side: u32) -> Row {
    let scene = scene(side);
    let mut moving = Moving::new(&scene, Way::ours(SWEEPS), scene.seconds.into());
    let mut stretch = 0.0;
    for tick in 0..180 {
        moving.step();
        if tick >= 120 {
            stretch = largest([stretch, moving.stretch()]);
        }
    }
    Row::new(&SWEEP_ORDER, OURS, [1.0, side.into()]).found(
        outcome_of(stretch),
        stretch,
        SWEEPS.into(),
    )
}

fn jobs(quick: bool) -> Vec<Job> {
    let sides: &[u32] = if quick { &[32] } else { &[32, 64] };
    let sweeps: &[u32] = if quick { &[1, 20] } else { &[1, 2, 4, 10, 20] };
    let mut jobs: Vec<Job> = Vec::new();
    for &side in sides {
        jobs.push(Box::new(move || vec![ours(side)]));
        for order in ORDERS {
            for &sweeps in sweeps {
                jobs.push(Box::new(move || vec![cell(order, side, sweeps)]));
            }
        }
    }
    jobs
}

/// The stretch of an order with one sweep a sub-step.
fn with_one(rows: &[Row], order: &str, side: f64) -> f64 {
    let cells = by(rows, order);
    let cell = cells.iter().find(|row| row.x == 1.0 && row.y == side);
    cell.map_or(f64::NAN, |row| row.measure)
}

fn check(rows: &[Row]) -> Result<(), String> {
    let (colours, by_row) = (with_one(rows, COLOURS, 32.0), with_one(rows, ROWS, 32.0));
    ensure(colours < 0.3, || format!("colour by colour: {colours}"))?;
    // NaN is no less.
    ensure(by_row > 1.0 || by_row.is_nan(), || {
        format!("row by row: {by_row}")
    })?;
    let ours = with_one(rows, OURS, 32.0);
    ensure(ours < colours, || format!("threads make it worse: {ours}"))
}

fn findings(rows: &[Row]) -> Vec<String> {
    let sides = values(rows, |row| row.y);
    let of = |side: f64| {
        let orders =
            ORDERS.map(|order| format!("{order} {}", percent(with_one(rows, order, side))));
        format!(
            "At {side}² with one sweep in each of 20 sub-steps the largest stretch is: {}; with threads solved {}.",
            orders.join(", "),
            percent(with_one(rows, OURS, side))
        )
    };
    let mut found: Vec<String> = sides.iter().map(|&side| of(side)).collect();
    let best = rows
        .iter()
        .filter(|row| row.method != OURS && row.y == sides[0])
        .min_by(|a, b| a.measure.total_cmp(&b.measure));
    if let Some(best) = best {
        found.push(format!(
            "Of 20 sweeps a tick at {}², {} sub-steps of {} are the best of sweeps: {}, {}.",
            sides[0],
            best.also,
            best.x,
            best.method,
            percent(best.measure)
        ));
    }
    found
}

pub fn chart(rows: &[Row]) -> Chart {
    let sides = values(rows, |row| row.y);
    let title = format!(
        "With one sweep a sub-step the order decides: at 32² {} row by row, {} colour by colour",
        percent(with_one(rows, ROWS, 32.0)),
        percent(with_one(rows, COLOURS, 32.0))
    );
    let subtitle = "Largest stretch in the third second of a rigid cloth, 2 m wide, hung by two corners; 20 sweeps in each tick of 1/60 s, shared out over 20, 10, 5, 2 or 1 sub-steps. At the top edge: beyond it, or not a number.";
    let mut chart = Chart::new("stability-order", title, subtitle)
        .sized([960, 500])
        .columns(sides.len());
    /// The edges of the chart (%).
    const ENDS: [f64; 2] = [1.0, 1.0e4];
    for side in sides {
        let names = [1.0, 2.0, 4.0, 10.0, 20.0]
            .map(|sweeps: f64| (sweeps, format!("{sweeps} × {}", 20.0 / sweeps)));
        let mut panel = Panel::new(
            format!("{side} × {side} particles"),
            Axis::log("sweeps × sub-steps in a tick")
                .between(0.85, 24.0)
                .named(names),
            Axis::log("largest stretch, %").between(ENDS[0], ENDS[1]),
        );
        for (style, method) in ORDERS.into_iter().chain([OURS]).enumerate() {
            let cells = by(rows, method).into_iter().filter(|row| row.y == side);
            let points = cells.map(|row| [row.x, between(100.0 * row.measure, ENDS)]);
            panel = panel.with(Series::new(
                method,
                Look::Style(style),
                Kind::Marked,
                points,
            ));
        }
        chart = chart.with(panel);
    }
    chart
}
