//! Maps of where methods fail: by time step, stiffness, order, speed, mass, precision, damping, start and size.
//!
//! Each map is a grid of cells, a cell being one short simulation. Where nothing else is said other methods run in f64,
//! so that what fails is the method and not its rounding; the library's solver runs as it is, in f32.

mod cloth;
mod damping;
mod mass;
mod order;
mod precision;
mod size;
mod starts;
mod step;
mod tunnelling;

use std::{
    collections::BTreeMap,
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use serde::{Deserialize, Serialize};

use crate::{
    chart::{Chart, Look, number},
    experiment::{Experiment, Run, Table},
    measure::distinct,
};

pub struct Stability;

/// One cell of a map.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Row {
    map: String,
    method: String,
    /// What they are, the header says for each map.
    x: f64,
    y: f64,
    outcome: String,
    measure: f64,
    also: f64,
}

impl Row {
    fn new(map: &Map, method: impl Into<String>, at: [f64; 2]) -> Self {
        Self {
            map: map.name.into(),
            method: method.into(),
            x: at[0],
            y: at[1],
            outcome: String::new(),
            measure: f64::NAN,
            also: f64::NAN,
        }
    }

    /// What came of it.
    fn found(mut self, outcome: &str, measure: f64, also: f64) -> Self {
        self.outcome = outcome.into();
        (self.measure, self.also) = (measure, also);
        self
    }
}

/// Simulates one cell, or a few that belong together.
type Job = Box<dyn Fn() -> Vec<Row> + Send + Sync>;

/// One map: its cells, what must hold of them and what they say.
struct Map {
    name: &'static str,
    /// What the columns hold.
    columns: &'static str,
    /// Its cells, fewer of them in a short run.
    jobs: fn(bool) -> Vec<Job>,
    check: fn(&[Row]) -> Result<(), String>,
    findings: fn(&[Row]) -> Vec<String>,
}

const MAPS: [&Map; 12] = [
    &step::STEP_STIFFNESS,
    &order::SWEEP_ORDER,
    &tunnelling::TUNNELLING,
    &mass::MASS_RATIO,
    &precision::VERLET_FORM,
    &precision::ORIGIN,
    &damping::DAMPING,
    &damping::FALLING,
    &starts::STARTS,
    &size::SUBSTEP_SIZE,
    &size::FALL,
    &size::PULLED,
];

impl Experiment for Stability {
    type Row = Row;

    const NAME: &'static str = "stability";

    fn run(run: &mut Run) -> Vec<Row> {
        let mut jobs = Vec::new();
        for map in MAPS {
            run.set(map.name, map.columns);
            jobs.extend((map.jobs)(run.quick));
        }
        run.begin(Self::NAME, jobs.len());
        on_two_threads(&jobs, || run.step())
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for map in MAPS {
            let rows = of(rows, map);
            ensure(!rows.is_empty(), || format!("{} has no cells", map.name))?;
            (map.check)(&rows).map_err(|error| format!("{}: {error}", map.name))?;
        }
        Ok(())
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        MAPS.iter()
            .flat_map(|map| (map.findings)(&of(rows, map)))
            .collect()
    }

    /// How many cells had which outcome.
    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new(["map", "method", "cells", "of which"]);
        for map in MAPS {
            let rows = of(rows, map);
            for method in methods(&rows) {
                let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
                let cells = by(&rows, method);
                for row in &cells {
                    *counts.entry(&row.outcome).or_default() += 1;
                }
                let counts: Vec<String> = counts
                    .into_iter()
                    .map(|(outcome, count)| format!("{outcome} {count}"))
                    .collect();
                let (map, method) = (map.name.into(), method.into());
                table.row([map, method, cells.len().to_string(), counts.join(", ")]);
            }
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![
            step::chart(&of(rows, &step::STEP_STIFFNESS)),
            order::chart(&of(rows, &order::SWEEP_ORDER)),
            tunnelling::chart(&of(rows, &tunnelling::TUNNELLING)),
            mass::chart(&of(rows, &mass::MASS_RATIO)),
            precision::chart(
                &of(rows, &precision::VERLET_FORM),
                &of(rows, &precision::ORIGIN),
            ),
            damping::chart(&of(rows, &damping::DAMPING), &of(rows, &damping::FALLING)),
            starts::chart(&of(rows, &starts::STARTS)),
            size::chart(&of(rows, &size::SUBSTEP_SIZE)),
            size::chart_of_steps(&of(rows, &size::FALL), &of(rows, &size::PULLED)),
        ]
    }
}

/// Does all jobs on two threads; the rows come in the order of the jobs.
fn on_two_threads(jobs: &[Job], done: impl Fn() + Sync) -> Vec<Row> {
    let next = AtomicUsize::new(0);
    let found = Mutex::new(BTreeMap::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                // The last ones first: in most maps they take longest.
                while let Some(index) = jobs
                    .len()
                    .checked_sub(1 + next.fetch_add(1, Ordering::Relaxed))
                {
                    let rows = jobs[index]();
                    found
                        .lock()
                        .expect("no job has panicked")
                        .insert(index, rows);
                    done();
                }
            });
        }
    });
    let found = found.into_inner().expect("no job has panicked");
    found.into_values().flatten().collect()
}

const HOLDS: &str = "holds";
const OVERSTRETCHED: &str = "overstretched";
const TORN: &str = "torn";
const SHREDDED: &str = "shredded";

/// What a cloth is called whose largest stretch is this: five per cent is what an eye notices, a thread of twice its
/// length would have torn, and one of eleven times, or one whose length is NaN, is what no cloth is any more.
fn outcome_of(stretch: f64) -> &'static str {
    match stretch {
        ..=0.05 => HOLDS,
        ..=1.0 => OVERSTRETCHED,
        ..=10.0 => TORN,
        _ => SHREDDED,
    }
}

/// Outcomes by stretch, as they are drawn.
const BY_STRETCH: [(&str, Look); 4] = [
    (HOLDS, Look::Style(2)),
    (OVERSTRETCHED, Look::Style(4)),
    (TORN, Look::Style(3)),
    (SHREDDED, Look::Style(1)),
];

/// A stretch as it is said.
fn percent(stretch: f64) -> String {
    match 100.0 * stretch {
        ..9.95 => format!("{:.1} %", 100.0 * stretch),
        ..9999.5 => format!("{:.0} %", 100.0 * stretch),
        beyond if beyond.is_nan() => "not a number".into(),
        beyond => format!("{} %", number(10f64.powf(beyond.log10().round()))),
    }
}

/// Different values of a column, in the order of their size.
fn values(rows: &[Row], column: impl Fn(&Row) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = rows.iter().map(column).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// A value between the edges of a chart; what is beyond lies on them, and NaN on the far one.
fn between(value: f64, [low, high]: [f64; 2]) -> f64 {
    if value.is_nan() {
        high
    } else {
        value.clamp(low, high)
    }
}

fn ensure(holds: bool, error: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(error()) }
}

/// The cells of a map.
fn of(rows: &[Row], map: &Map) -> Vec<Row> {
    let rows = rows.iter().filter(|row| row.map == map.name);
    rows.cloned().collect()
}

/// The cells of a method.
fn by<'a>(rows: &'a [Row], method: &str) -> Vec<&'a Row> {
    rows.iter().filter(|row| row.method == method).collect()
}

/// The methods, in the order in which they appear.
fn methods(rows: &[Row]) -> Vec<&str> {
    distinct(rows.iter().map(|row| row.method.as_str()))
}

/// The largest of some values; NaN if one of them is, 0 of none.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |largest: f64, value| {
        if value.is_nan() || largest.is_nan() {
            f64::NAN
        } else {
            largest.max(value)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn stability_has_every_map() {
        let rows = quick::<Stability>(View::Nothing, "map,method,x,y,outcome,measure");
        for map in MAPS {
            let rows = of(&rows, map);
            assert!(rows.len() > 2, "{}", map.name);
            assert!(rows.iter().all(|row| !row.outcome.is_empty()));
        }
    }

    #[test]
    fn what_is_not_a_number_is_not_lost() {
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan());
        assert_eq!(largest([1.0, 3.0, 2.0]), 3.0);
    }
}
