//! What colliders cost, by their number, by what they do, and by their shape.
//!
//! An app without a renderer, its systems one after the other: all of the plugin's systems in a tick, with colliders and, in the
//! same turns, without. Colliders that are far cost what the broad phase does; those that are touched cost the response.

mod charts;
mod shapes;
mod stage;

use serde::{Deserialize, Serialize};

use crate::{
    chart::Chart,
    experiment::{Experiment, Run, Table},
    measure::Spread,
};
use shapes::shapes;
use stage::{Stage, State};

pub struct Colliders;

/// Some cloths and some colliders.
#[derive(Debug, Serialize, Deserialize)]
pub struct Row {
    cloths: u32,
    colliders: u32,
    state: String,
    shape: String,
    /// All of the plugin's systems, in the median.
    ms_per_tick: f64,
    /// The same cloths without colliders.
    ms_without: f64,
    /// Quartiles of the first.
    ms_low: f64,
    ms_high: f64,
    /// Particles along each side of a cloth.
    side: u32,
    /// Whether colliders were near, touched and cloths asleep as the state says.
    is_as_said: bool,
}

impl Row {
    /// What the colliders add to a tick (ms).
    fn added(&self) -> f64 {
        self.ms_per_tick - self.ms_without
    }
}

/// Particles along the sides of a cloth that is one of many, and of one that is touched.
const SMALL: u32 = 8;
const LARGE: u32 = 48;

impl Experiment for Colliders {
    type Row = Row;

    const NAME: &'static str = "colliders";

    fn run(run: &mut Run) -> Vec<Row> {
        let turns = run.either(20, 300);
        let many = run.either(50, 1000);
        let numbers = run.either(&[1, 10, 100][..], &[1, 10, 100, 1000, 10_000]);
        let ball = shapes().swap_remove(0);
        let mut scenes = Vec::new();
        for state in [State::Awake, State::Moving] {
            scenes.extend(
                numbers
                    .iter()
                    .map(|&number| ([1, SMALL], number, state, ball.clone())),
            );
        }
        for state in [State::Awake, State::Asleep, State::AsleepMoving] {
            scenes.extend(
                numbers
                    .iter()
                    .map(|&number| ([many, SMALL], number, state, ball.clone())),
            );
        }
        for shape in shapes() {
            // A plane is below all cloths at once.
            scenes.push(([1, LARGE], 1, State::Touching, shape));
        }
        run.set("scene", "cloths 1.6 m wide, 3 m apart; far colliders 30 m below them, 3 m apart; touched ones under the cloth's middle");
        run.set("turns", turns);
        run.set("tick", "all of the plugin's systems, one after the other on one thread; colliders and none in turns");
        run.begin(Self::NAME, scenes.len());
        let mut rows = Vec::new();
        for (cloths, colliders, state, (name, shape)) in scenes {
            let mut stages = [0, colliders].map(|number| Stage::new(cloths, number, state, &shape));
            // Until cloths sleep that shall, and lie that fall.
            stages.iter_mut().for_each(|stage| stage.warm_up(150));
            for _ in 0..turns {
                stages.iter_mut().for_each(Stage::turn);
            }
            let [without, with] = stages.each_ref().map(|stage| Spread::of(stage.ms()));
            let is_as_said = stages.iter_mut().all(Stage::is_as_said);
            rows.push(Row {
                cloths: cloths[0],
                colliders,
                state: state.name().into(),
                shape: name.into(),
                ms_per_tick: with.median,
                ms_without: without.median,
                ms_low: with.low,
                ms_high: with.high,
                side: cloths[1],
                is_as_said,
            });
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        match rows.iter().find(|row| !row.is_as_said) {
            Some(row) => Err(format!(
                "{} cloths and {} colliders, {}: something is near, touches or sleeps that should not, or the other way round",
                row.cloths, row.colliders, row.state
            )),
            None => Ok(()),
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let mut findings = Vec::new();
        for (cloths, state) in groups(rows) {
            let most = of(rows, cloths, &state).max_by_key(|row| row.colliders);
            if let Some(row) = most {
                findings.push(format!(
                    "{cloths} {} and {} colliders, {state}: {:.3} ms a tick, {:+.3} ms of it for the colliders ({:+.1} %).",
                    if cloths == 1 { "cloth" } else { "cloths" },
                    row.colliders,
                    row.ms_per_tick,
                    row.added(),
                    100.0 * row.added() / row.ms_without
                ));
            }
        }
        for row in touching(rows) {
            findings.push(format!(
                "A cloth of {}² on a {}: {:.2} × the tick without contact.",
                row.side,
                row.shape,
                row.ms_per_tick / row.ms_without
            ));
        }
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "state",
            "shape",
            "cloths",
            "colliders",
            "ms a tick",
            "without",
        ]);
        for row in rows {
            table.row([
                row.state.clone(),
                row.shape.clone(),
                row.cloths.to_string(),
                row.colliders.to_string(),
                format!("{:.4}", row.ms_per_tick),
                format!("{:.4}", row.ms_without),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![charts::all(rows)]
    }
}

/// Numbers of cloths and states in which colliders are far, each once.
fn groups(rows: &[Row]) -> Vec<(u32, String)> {
    let far = rows
        .iter()
        .filter(|row| row.state != State::Touching.name());
    crate::measure::distinct(far.map(|row| (row.cloths, row.state.clone())))
}

fn of<'a>(rows: &'a [Row], cloths: u32, state: &'a str) -> impl Iterator<Item = &'a Row> {
    rows.iter()
        .filter(move |row| row.cloths == cloths && row.state == state)
}

fn touching(rows: &[Row]) -> impl Iterator<Item = &Row> {
    rows.iter()
        .filter(|row| row.state == State::Touching.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn colliders_are_measured_by_number_and_shape() {
        let rows = quick::<Colliders>(
            View::Nothing,
            "cloths,colliders,state,shape,ms_per_tick,ms_without",
        );
        assert_eq!(groups(&rows).len(), 5);
        assert_eq!(touching(&rows).count(), shapes().len());
        assert!(
            rows.iter()
                .all(|row| row.ms_per_tick > 0.0 && row.ms_without > 0.0)
        );
        assert!(rows.iter().all(|row| row.ms_low <= row.ms_high));
    }
}
