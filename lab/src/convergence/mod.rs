//! With which power of the sub-step errors fall, in motions that are smooth in time.
//!
//! Errors are RMS distances after half a second to the same springs in f64, by explicit steps of 1/30,720 s.

use bevy_drape::solver::{TickStep, TimeOrder};
use examples_shared::smooth::Smooth;
use serde::{Deserialize, Serialize};

use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series, number},
    experiment::{Experiment, Run, Table},
    measure::{distinct, exponent},
};

const OURS: &str = "threads";
const FORCES: &str = "forces";
const FIRST: &str = "threads, first order";

/// Names of methods, and a tick by each.
const METHODS: [(&str, fn(u32) -> TickStep); 3] = [
    (OURS, second),
    (FORCES, second),
    (FIRST, |substeps| TickStep {
        substeps,
        order: TimeOrder::First,
        ..TickStep::default()
    }),
];

/// What our errors fall with, at least; and where all directions of threads pull at the same time: they are solved one after the
/// other, and what each leaves to the next is of first order.
const MIN_ORDER: f64 = 1.7;
const MIN_ORDER_OF_FALLS: f64 = 0.9;

/// Below this, rounding counts (mm).
const ROUNDING: f64 = 4.0e-3;

fn second(substeps: u32) -> TickStep {
    TickStep {
        substeps,
        ..TickStep::default()
    }
}

pub struct Convergence;

/// One motion, by one method in so many sub-steps.
#[derive(Serialize, Deserialize)]
pub struct Row {
    scene: String,
    method: String,
    substeps: u32,
    error_mm: f64,
    /// log₂ of how many times smaller the error is than with half as many sub-steps; of the fewest, nothing.
    order: Option<f64>,
}

impl Experiment for Convergence {
    type Row = Row;

    const NAME: &'static str = "convergence";

    fn run(run: &mut Run) -> Vec<Row> {
        let motions = if run.quick {
            &Smooth::ALL[..3]
        } else {
            &Smooth::ALL[..]
        };
        run.set("scenes", "undamped, 60 ticks a second, threads and the diagonals of falls give 1 mm/N; RMS error after 0.5 s against the same springs in f64");
        run.begin(Self::NAME, motions.len());
        let mut rows = Vec::new();
        for motion in motions {
            let (reference, apart) = motion.reference();
            run.set(
                motion.name,
                format!("the reference is {apart:.1e} m from the same with half of its steps"),
            );
            for (method, step) in METHODS {
                let mut before: Option<(u32, f64)> = None;
                for substeps in motion.substeps {
                    let error = motion.error(step(substeps), method == FORCES, &reference);
                    let Some(error) = error else {
                        continue;
                    };
                    let error_mm = 1.0e3 * error;
                    let order = before.map(|(fewer, larger)| {
                        (larger / error_mm).log2() / f64::from(substeps / fewer).log2()
                    });
                    before = Some((substeps, error_mm));
                    rows.push(Row {
                        scene: motion.name.into(),
                        method: method.into(),
                        substeps,
                        error_mm,
                        order,
                    });
                }
            }
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        if let Some(row) = rows.iter().find(|row| !row.error_mm.is_finite()) {
            return Err(format!("{}, {}: NaN", row.scene, row.method));
        }
        for scene in scenes(rows) {
            let order = order(rows, scene, OURS);
            // NaN is not.
            let least = if scene.starts_with("fall") {
                MIN_ORDER_OF_FALLS
            } else {
                MIN_ORDER
            };
            let is_high = order >= least;
            if !is_high {
                return Err(format!("{scene}: threads are of order {order:.2}"));
            }
        }
        Ok(())
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let each = scenes(rows).into_iter().map(|scene| {
            let error = |method: &str| {
                let found = of(rows, scene, method).find(|row| row.substeps >= 16);
                found.map_or(String::new(), |row| {
                    let error = number((1.0e4 * row.error_mm).round() / 1.0e4);
                    format!("{error} mm at {}", row.substeps)
                })
            };
            let forces = of(rows, scene, FORCES).next();
            let forces = forces.map_or(String::new(), |row| {
                let error = number((1.0e4 * row.error_mm).round() / 1.0e4);
                format!("; forces, from {} sub-steps on, {error} mm", row.substeps)
            });
            format!(
                "{scene}: threads are of order {:.2} and {} sub-steps, of first order {:.2} and {}{forces}.",
                order(rows, scene, OURS),
                error(OURS),
                order(rows, scene, FIRST),
                error(FIRST)
            )
        });
        each.collect()
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new(["scene", "method", "sub-steps", "error, mm", "order"]);
        for row in rows {
            table.row([
                row.scene.clone(),
                row.method.clone(),
                row.substeps.to_string(),
                format!("{:.4}", row.error_mm),
                row.order
                    .map_or_else(String::new, |order| format!("{order:.2}")),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![chart(rows)]
    }
}

fn scenes(rows: &[Row]) -> Vec<&str> {
    distinct(rows.iter().map(|row| row.scene.as_str()))
}

fn of<'a>(rows: &'a [Row], scene: &'a str, method: &'a str) -> impl Iterator<Item = &'a Row> {
    rows.iter()
        .filter(move |row| row.scene == scene && row.method == method)
}

/// Slope of all errors that are more than rounding.
fn order(rows: &[Row], scene: &str, method: &str) -> f64 {
    let points: Vec<[f64; 2]> = of(rows, scene, method)
        .filter(|row| row.error_mm > ROUNDING)
        .map(|row| [f64::from(row.substeps), row.error_mm])
        .collect();
    -exponent(&points)
}

/// A panel a scene, with lines of slope 1 and 2.
fn chart(rows: &[Row]) -> Chart {
    let scenes = scenes(rows);
    let orders = scenes.iter().map(|scene| order(rows, scene, OURS));
    let lowest = orders.fold(f64::INFINITY, f64::min);
    let mut chart = Chart::new(
        "convergence",
        format!("Errors of threads fall with the power {lowest:.1} of the sub-step, or more; forces are at rounding"),
        "RMS position error after half a second, against the same springs in f64. Dashed: slopes of first and of second order.",
    )
    .sized([960, 900])
    .columns(2);
    for scene in scenes {
        let mut panel = Panel::new(
            scene,
            Axis::log("sub-steps a 1/60 s, log"),
            Axis::log("RMS error (mm), log"),
        );
        for (style, (method, _)) in METHODS.into_iter().enumerate() {
            let points = of(rows, scene, method).map(|row| [f64::from(row.substeps), row.error_mm]);
            let look = Look::Style(style);
            panel = panel.with(Series::new(method, look, Kind::Marked, points));
        }
        let ours: Vec<&Row> = of(rows, scene, OURS).collect();
        if let [first, .., last] = ours[..] {
            let ratio = f64::from(last.substeps) / f64::from(first.substeps);
            for power in [1, 2] {
                let ends = [
                    [f64::from(first.substeps), first.error_mm],
                    [f64::from(last.substeps), first.error_mm / ratio.powi(power)],
                ];
                let middle = [
                    (ends[0][0] * ends[1][0]).sqrt(),
                    (ends[0][1] * ends[1][1]).sqrt(),
                ];
                panel = panel
                    .with(Series::new("", Look::Ink, Kind::Line, ends))
                    .note(middle, format!("slope {power}"));
            }
        }
        chart = chart.with(panel);
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn errors_are_measured_by_both_methods() {
        let rows = quick::<Convergence>(View::Nothing, "scene,method,substeps,error_mm,order");
        let threads = rows.iter().filter(|row| row.method != FORCES);
        assert_eq!(threads.count(), 3 * 2 * 6);
        let firsts = rows.iter().filter(|row| row.order.is_none());
        assert_eq!(firsts.count(), 3 * 3);
    }

    #[test]
    fn order_is_that_of_a_power_law() {
        let row = |substeps: u32| Row {
            scene: String::new(),
            method: OURS.into(),
            substeps,
            error_mm: 100.0 / f64::from(substeps * substeps),
            order: None,
        };
        let rows = [5, 10, 20].map(row);
        assert!((order(&rows, "", OURS) - 2.0).abs() < 1e-12);
    }
}
