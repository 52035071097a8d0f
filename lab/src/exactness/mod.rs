//! Which contacts a search misses and which it imagines, against brute force in f64 on random states.
//!
//! Each state is a cloth of 4 to 33 particles a side, bent, folded and drawn out to a given largest stretch, searched for
//! balls of six radii, each near one of its particles. All volumes and rules search the same states.

mod charts;
mod states;

use bevy_drape::hierarchy::{BoundRule, NodeBounds, TopDownQuery, brute_force};
use serde::{Deserialize, Serialize};

use crate::{
    chart::Chart,
    cloths::CHOICES,
    experiment::{Experiment, Run, Table},
    measure::{Random, distinct},
};
use states::State;

/// Radius of the ball over the spacing.
const RADII: [f32; 6] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0];

/// Largest stretch of a spring.
const STRETCHES: [f32; 5] = [0.0, 0.01, 0.1, 0.5, 2.0];

const SCAN: &str = "scan";

pub struct Exactness;

/// What one volume and rule made of all states of a radius and a stretch.
#[derive(Serialize, Deserialize)]
pub struct Row {
    volume: String,
    rule: String,
    radius_over_spacing: f32,
    stretch: f32,
    states: u32,
    /// What brute force finds in all of them.
    contacts: usize,
    missed: usize,
    /// Nodes, or particles of a scan, looked at in a state, on average.
    visited: f64,
    /// Found, but not by brute force.
    false_contacts: usize,
    /// States in which something touches, and those of them in which something is missed.
    states_with_contacts: u32,
    states_with_misses: u32,
}

impl Row {
    fn new([volume, rule]: [&str; 2], radius: f32, stretch: f32) -> Self {
        Self {
            volume: volume.into(),
            rule: rule.into(),
            radius_over_spacing: radius,
            stretch,
            states: 0,
            contacts: 0,
            missed: 0,
            visited: 0.0,
            false_contacts: 0,
            states_with_contacts: 0,
            states_with_misses: 0,
        }
    }

    /// Takes what a search found, and what there is.
    fn count(&mut self, found: &[u32], truth: &[u32], visited: usize) {
        let [missed, false_contacts] = missed_and_false(found, truth);
        self.states += 1;
        self.contacts += truth.len();
        self.missed += missed;
        self.false_contacts += false_contacts;
        self.states_with_contacts += u32::from(!truth.is_empty());
        self.states_with_misses += u32::from(missed > 0);
        self.visited += (visited as f64 - self.visited) / f64::from(self.states);
    }

    fn is_paper(&self) -> bool {
        self.rule == BoundRule::Paper.name()
    }
}

impl Experiment for Exactness {
    type Row = Row;

    const NAME: &'static str = "exactness";

    fn run(run: &mut Run) -> Vec<Row> {
        let states = run.either(100, 4000);
        run.set(
            "states",
            format!("{states} cloths for each stretch, each with a ball of every radius"),
        );
        run.set(
            "cloths",
            "4 to 33 particles a side, bent and folded, then pulled, waved and shaken to the stretch",
        );
        run.set("particles", "of a radius of a tenth of the spacing");
        let mut rows = Vec::new();
        let mut query = TopDownQuery::default();
        let mut bounds = vec![NodeBounds::default(); CHOICES.len()];
        run.begin(Self::NAME, STRETCHES.len() * states / 20);
        for (at, stretch) in STRETCHES.into_iter().enumerate() {
            let mut random = Random(at as u64 + 1);
            let first = rows.len();
            for radius in RADII {
                let trees = CHOICES.iter();
                let trees = trees.map(|(volume, rule)| [volume.name(), rule.name()]);
                let kinds = trees.chain([["particles", SCAN]]);
                rows.extend(kinds.map(|kind| Row::new(kind, radius, stretch)));
            }
            for turn in 0..states {
                let state = State::new(&mut random, stretch);
                for (bounds, &choice) in bounds.iter_mut().zip(CHOICES.iter()) {
                    bounds
                        .rebuild(choice, &state.tree, &state.particles, state.stretch)
                        .expect("there is such a rule");
                }
                let of_radii = rows[first..].chunks_mut(CHOICES.len() + 1);
                for (rows, radius) in of_radii.zip(RADII) {
                    search(&state, &mut random, radius, &bounds, &mut query, rows);
                }
                if turn % 20 == 0 {
                    run.step();
                }
            }
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for row in rows {
            let name = format!(
                "{} by {}, ball of {} spacings, stretch {}",
                row.volume, row.rule, row.radius_over_spacing, row.stretch
            );
            if row.missed > 0 && !row.is_paper() {
                return Err(format!("{name}: {} contacts missed", row.missed));
            }
            if row.false_contacts > 0 {
                return Err(format!("{name}: {} false contacts", row.false_contacts));
            }
            if row.contacts == 0 || row.states == 0 {
                return Err(format!("{name}: nothing touches"));
            }
        }
        let strata = RADII.len() * STRETCHES.len();
        if rows.len() == strata * (CHOICES.len() + 1) {
            Ok(())
        } else {
            Err("every volume and rule, radius and stretch".into())
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let exact = || rows.iter().filter(|row| !row.is_paper());
        let states: u32 = of(rows, "particles", SCAN).map(|row| row.states).sum();
        let contacts: usize = of(rows, "particles", SCAN).map(|row| row.contacts).sum();
        let paper = |volume| move |row: &&Row| row.is_paper() && row.volume == volume;
        let missed = |volume, of: &dyn Fn(&Row) -> bool| {
            let rows = rows.iter().filter(paper(volume)).filter(|row| of(row));
            share(rows)
        };
        let wrong = |volume| {
            let [touching, wrong] = rows.iter().filter(paper(volume)).fold([0, 0], |sum, row| {
                [
                    sum[0] + row.states_with_contacts,
                    sum[1] + row.states_with_misses,
                ]
            });
            100.0 * f64::from(wrong) / f64::from(touching)
        };
        let least = |radius: f32| move |row: &Row| row.radius_over_spacing == radius;
        let at = |stretch: f32| move |row: &Row| row.stretch == stretch;
        let visited = |volume, rule, stretch: f32| {
            let rows = of(rows, volume, rule).filter(|row| row.stretch == stretch);
            let all: Vec<f64> = rows.map(|row| row.visited).collect();
            all.iter().sum::<f64>() / all.len() as f64
        };
        vec![
            format!(
                "Outside of the rule Paper {} contacts of {contacts} were missed and {} imagined, by 8 volumes and rules and the scan, in {states} random states.",
                exact().map(|row| row.missed).sum::<usize>(),
                exact().map(|row| row.false_contacts).sum::<usize>(),
            ),
            format!(
                "The paper's spheres miss {:.1} % of the contacts, in {:.0} % of the states that have any; its AABBs {:.1} %, in {:.0} %. Neither imagines one.",
                missed("spheres", &|_| true),
                wrong("spheres"),
                missed("AABBs", &|_| true),
                wrong("AABBs"),
            ),
            format!(
                "By stretch, from none over 10 % to 200 %: spheres miss {:.1}, {:.1} and {:.1} %, AABBs {:.1}, {:.1} and {:.1} %. By the ball's radius, 0.25, 1 and 8 spacings: spheres {:.1}, {:.1} and {:.1} %, AABBs {:.1}, {:.1} and {:.1} %.",
                missed("spheres", &at(0.0)),
                missed("spheres", &at(0.1)),
                missed("spheres", &at(2.0)),
                missed("AABBs", &at(0.0)),
                missed("AABBs", &at(0.1)),
                missed("AABBs", &at(2.0)),
                missed("spheres", &least(0.25)),
                missed("spheres", &least(1.0)),
                missed("spheres", &least(8.0)),
                missed("AABBs", &least(0.25)),
                missed("AABBs", &least(1.0)),
                missed("AABBs", &least(8.0)),
            ),
            format!(
                "The rest shape's price: its spheres look at {:.0} nodes a search of unstretched cloth and at {:.0} at a stretch of 200 %, where refitted AABBs look at {:.0} and {:.0}, OBBs at {:.0} and {:.0}, 26-DOPs at {:.0} and {:.0}.",
                visited("spheres", "rest shape", 0.0),
                visited("spheres", "rest shape", 2.0),
                visited("AABBs", "refit", 0.0),
                visited("AABBs", "refit", 2.0),
                visited("OBBs", "refit", 0.0),
                visited("OBBs", "refit", 2.0),
                visited("26-DOPs", "refit", 0.0),
                visited("26-DOPs", "refit", 2.0),
            ),
        ]
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "volume",
            "rule",
            "contacts",
            "missed",
            "missed %",
            "false",
            "visited a state",
        ]);
        for [volume, rule] in kinds(rows) {
            let all: Vec<&Row> = of(rows, volume, rule).collect();
            let sum = |value: fn(&Row) -> usize| all.iter().map(|row| value(row)).sum::<usize>();
            let visited = all.iter().map(|row| row.visited).sum::<f64>() / all.len() as f64;
            table.row([
                volume.into(),
                rule.into(),
                sum(|row| row.contacts).to_string(),
                sum(|row| row.missed).to_string(),
                format!("{:.2}", share(all.iter().copied())),
                sum(|row| row.false_contacts).to_string(),
                format!("{visited:.0}"),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![charts::misses(rows), charts::tightness(rows)]
    }
}

/// Lets all volumes and rules search a state for one ball.
fn search(
    state: &State,
    random: &mut Random,
    radius: f32,
    bounds: &[NodeBounds],
    query: &mut TopDownQuery,
    rows: &mut [Row],
) {
    let ball = state.ball(random, radius);
    let truth = brute_force(&state.particles, &ball);
    let scan = [None];
    let all = bounds.iter().map(Some).chain(scan);
    for (bounds, row) in all.zip(rows) {
        query.clear();
        match bounds {
            Some(bounds) => query.search(&state.tree, bounds, &state.particles, &ball),
            None => query.scan(&state.particles, &ball),
        };
        row.count(
            query.candidates(),
            &truth,
            query.nodes_visited().max(query.leaf_tests()),
        );
    }
}

/// How many contacts of the truth a search has not found, and how many it found that are not of it, or twice; in any order.
pub fn missed_and_false(found: &[u32], truth: &[u32]) -> [usize; 2] {
    let mut sorted = found.to_vec();
    sorted.sort_unstable();
    let is_missed = |particle: &&u32| sorted.binary_search(particle).is_err();
    let missed = truth.iter().filter(is_missed).count();
    [missed, found.len() - (truth.len() - missed)]
}

/// Part of the contacts that is missed (%).
fn share<'a>(rows: impl Iterator<Item = &'a Row>) -> f64 {
    let [contacts, missed] = rows.fold([0, 0], |[contacts, missed], row| {
        [contacts + row.contacts, missed + row.missed]
    });
    100.0 * missed as f64 / contacts.max(1) as f64
}

fn kinds(rows: &[Row]) -> Vec<[&str; 2]> {
    distinct(
        rows.iter()
            .map(|row| [row.volume.as_str(), row.rule.as_str()]),
    )
}

fn of<'a>(rows: &'a [Row], volume: &'a str, rule: &'a str) -> impl Iterator<Item = &'a Row> {
    rows.iter()
        .filter(move |row| row.volume == volume && row.rule == rule)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn missed_and_false_are_counted_apart() {
        assert_eq!(missed_and_false(&[7, 1, 4], &[1, 4, 7]), [0, 0]);
        assert_eq!(missed_and_false(&[7, 2], &[1, 4, 7]), [2, 1]);
        assert_eq!(missed_and_false(&[5, 5], &[5]), [0, 1]);
        assert_eq!(missed_and_false(&[], &[]), [0, 0]);
    }

    #[test]
    fn exactness_is_exact_but_for_the_papers_rule() {
        let rows = quick::<Exactness>(
            View::Nothing,
            "volume,rule,radius_over_spacing,stretch,states,contacts,missed,visited,false_contacts",
        );
        for volume in ["spheres", "AABBs"] {
            let missed = share(of(&rows, volume, "paper"));
            assert!(missed > 0.1 && missed < 50.0, "{volume}: {missed} %");
        }
    }
}
