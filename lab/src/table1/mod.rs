//! The paper's time execution test: how long the search of its scene takes, 20 times, by every volume and rule.
//!
//! One run goes through all ticks of the recorded scene: in each, every node's volume is brought up to date by its
//! rule, and the tree is searched from the top for the ball.

mod charts;

use std::hint::black_box;

use bevy_drape::hierarchy::{BoundRule, BoundingVolume, NodeBounds, TopDownQuery, brute_force};
use serde::{Deserialize, Serialize};

use crate::{
    chart::Chart,
    cloths::{CHOICES, Recording, State},
    exactness::missed_and_false,
    experiment::{Experiment, Run, Table},
    measure::{Spread, distinct, median, seconds},
    parry::ParryTree,
};

/// The paper's Table 1 (ms).
const PUBLISHED: &str = include_str!("../../../assets/lab/paper_table1.csv");

/// Of the rows that the paper published.
const IN_PRINT: &str = "as published";

pub struct Table1;

/// One run of one volume and rule.
#[derive(Serialize, Deserialize)]
pub struct Row {
    run: u32,
    volume: String,
    rule: String,
    ms: f64,
    /// Nodes, or particles where there is no tree, that a tick looks at, on average; 0 where that is not known.
    visited: f64,
    /// Contacts of all ticks, and those that were not found.
    contacts: usize,
    missed: usize,
    /// The rebuild of all ticks timed once more without the queries, and what that leaves of `ms`.
    rebuild_ms: f64,
    query_ms: f64,
    /// Found, but not by brute force.
    false_contacts: usize,
}

/// One way to search.
enum Searcher {
    Tree(Box<NodeBounds>, (BoundingVolume, BoundRule)),
    Scan,
    /// In f64, one by one.
    Brute,
    Parry(Box<ParryTree>),
}

impl Searcher {
    fn all(recording: &Recording) -> Vec<Self> {
        let trees = CHOICES
            .iter()
            .map(|&choice| Self::Tree(Box::default(), choice));
        let first = &recording.states[0].particles;
        let others = [
            Self::Scan,
            Self::Brute,
            Self::Parry(Box::new(ParryTree::new(first))),
        ];
        trees.chain(others).collect()
    }

    fn names(&self) -> [&'static str; 2] {
        match self {
            Self::Tree(_, (volume, rule)) => [volume.name(), rule.name()],
            Self::Scan => ["particles", "scan"],
            Self::Brute => ["particles", "brute force, f64"],
            Self::Parry(_) => ["AABBs", "parry3d"],
        }
    }

    /// Brings all up to date.
    fn rebuild(&mut self, recording: &Recording, state: &State) {
        match self {
            Self::Tree(bounds, choice) => bounds
                .rebuild(*choice, &recording.tree, &state.particles, state.stretch)
                .expect("there is such a rule"),
            Self::Parry(tree) => tree.update(&state.particles, 0.0),
            Self::Scan | Self::Brute => {}
        }
    }

    fn has_rebuild(&self) -> bool {
        !matches!(self, Self::Scan | Self::Brute)
    }

    /// Brings all up to date, searches, and says how many contacts it found.
    fn search(&mut self, query: &mut TopDownQuery, recording: &Recording, state: &State) -> usize {
        let State {
            particles, ball, ..
        } = state;
        query.clear();
        if matches!(self, Self::Tree(..)) {
            self.rebuild(recording, state);
        }
        match self {
            Self::Tree(bounds, _) => query.search(&recording.tree, bounds, particles, ball).len(),
            Self::Scan => query.scan(particles, ball).len(),
            Self::Brute => brute_force(particles, ball).len(),
            // Brings it up to date, too.
            Self::Parry(tree) => tree.tick(particles, ball, 0.0),
        }
    }

    /// Goes through all ticks, and says what came of it.
    fn seen(&mut self, query: &mut TopDownQuery, recording: &Recording) -> Seen {
        let mut seen = Seen::default();
        let mut visited = 0;
        for state in &recording.states {
            let truth = brute_force(&state.particles, &state.ball);
            let count = self.search(query, recording, state);
            let [missed, false_contacts] = match self {
                Self::Tree(..) | Self::Scan => missed_and_false(query.candidates(), &truth),
                // It is the truth.
                Self::Brute => [0, 0],
                // It only counts, and each particle for itself.
                Self::Parry(_) => [
                    truth.len().saturating_sub(count),
                    count.saturating_sub(truth.len()),
                ],
            };
            seen.contacts += truth.len();
            seen.missed += missed;
            seen.false_contacts += false_contacts;
            visited += match self {
                Self::Tree(..) | Self::Scan => query.nodes_visited().max(query.leaf_tests()),
                Self::Brute => recording.grid.len(),
                Self::Parry(_) => 0,
            };
        }
        seen.visited = visited as f64 / recording.states.len() as f64;
        seen
    }
}

/// What a search of all ticks looks at and finds: the same in each run.
#[derive(Default)]
struct Seen {
    visited: f64,
    contacts: usize,
    missed: usize,
    false_contacts: usize,
}

impl Experiment for Table1 {
    type Row = Row;

    const NAME: &'static str = "table1";

    fn run(run: &mut Run) -> Vec<Row> {
        let ticks = run.either(192, 768);
        run.set("scene", format!("16 × 16 particles, ball of radius 1, {ticks} ticks of 1/64 s; a run searches them all"));
        run.set(
            "rebuild_ms",
            "a run of the rebuilds alone, just before; query_ms is what that leaves of ms",
        );
        run.set("published", "the paper's Table 1, on its machine");
        let recording = Recording::new(ticks);
        let mut searchers = Searcher::all(&recording);
        let mut query = TopDownQuery::default();
        let searchers_seen: Vec<Seen> = searchers
            .iter_mut()
            .map(|searcher| searcher.seen(&mut query, &recording))
            .collect();
        let mut rows = published();
        run.begin(Self::NAME, 20);
        for turn in 1..=20 {
            for (searcher, seen) in searchers.iter_mut().zip(&searchers_seen) {
                let states = &recording.states;
                let rebuild = if searcher.has_rebuild() {
                    seconds(|| {
                        for state in states {
                            black_box(&mut *searcher).rebuild(&recording, state);
                        }
                    })
                } else {
                    0.0
                };
                let all = seconds(|| {
                    for state in states {
                        black_box(searcher.search(&mut query, &recording, state));
                    }
                });
                let rebuild = rebuild.min(all);
                let [volume, rule] = searcher.names().map(String::from);
                rows.push(Row {
                    run: turn,
                    volume,
                    rule,
                    ms: 1.0e3 * all,
                    visited: seen.visited,
                    contacts: seen.contacts,
                    missed: seen.missed,
                    rebuild_ms: 1.0e3 * rebuild,
                    query_ms: 1.0e3 * (all - rebuild),
                    false_contacts: seen.false_contacts,
                });
            }
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for row in rows {
            if row.missed > 0 && row.rule != BoundRule::Paper.name() {
                return Err(format!(
                    "{} by {} missed {} contacts",
                    row.volume, row.rule, row.missed
                ));
            }
            if row.false_contacts > 0 {
                return Err(format!(
                    "{} by {} imagined {} contacts",
                    row.volume, row.rule, row.false_contacts
                ));
            }
        }
        match rows.first() {
            Some(row) if kinds(rows).len() == 15 && rows.len() == 15 * 20 && row.ms > 0.0 => Ok(()),
            _ => Err("20 runs of 13 searches and the paper's two".into()),
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let paper = BoundRule::Paper.name();
        let ms = |volume, rule| spread(rows, volume, rule).median;
        let seen = |volume, rule| {
            of(rows, volume, rule)
                .next()
                .map_or((0.0, 0, 0), |row| (row.visited, row.missed, row.contacts))
        };
        let apart = |volume, figure: fn(&Row) -> f64| {
            let runs: Vec<f64> = of(rows, volume, paper).map(figure).collect();
            median(&runs)
        };
        let part = |volume| apart(volume, |row| 100.0 * row.rebuild_ms / row.ms);
        let query = |volume| apart(volume, |row| row.query_ms);
        let published = ms("AABBs", IN_PRINT) / ms("spheres", IN_PRINT);
        let ratio = ms("AABBs", paper) / ms("spheres", paper);
        let (spheres, missed, contacts) = seen("spheres", paper);
        let (boxes, ..) = seen("AABBs", paper);
        vec![
            format!(
                "The paper's spheres were {published:.1} × as fast as its AABBs; on one tree, built by its rule, they are {ratio:.2} ×. They visit {spheres:.0} nodes a tick where AABBs visit {boxes:.0}, and miss {missed} of {contacts} contacts; of their {:.2} ms the rebuild is {:.0} % and the query {:.2} ms, of the {:.2} ms of AABBs the rebuild is {:.0} % and the query {:.2} ms.",
                ms("spheres", paper),
                part("spheres"),
                query("spheres"),
                ms("AABBs", paper),
                part("AABBs"),
                query("AABBs"),
            ),
            format!(
                "By the rest shape, which misses nothing, spheres take {:.2} ms and AABBs {:.2}; a scan of all 256 particles takes {:.2}, parry3d {:.1}, brute force in f64 {:.2}.",
                ms("spheres", BoundRule::RestShape.name()),
                ms("AABBs", BoundRule::RestShape.name()),
                ms("particles", "scan"),
                ms("AABBs", "parry3d"),
                ms("particles", "brute force, f64"),
            ),
        ]
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "volume",
            "rule",
            "ms, median",
            "quartiles",
            "rebuild ms",
            "query ms",
            "visited a tick",
            "missed",
        ]);
        for [volume, rule] in kinds(rows) {
            let times = spread(rows, volume, rule);
            let Some(row) = of(rows, volume, rule).next() else {
                continue;
            };
            let apart = |figure: fn(&Row) -> f64| {
                let runs: Vec<f64> = of(rows, volume, rule).map(figure).collect();
                format!("{:.3}", median(&runs))
            };
            table.row([
                volume.into(),
                rule.into(),
                format!("{:.3}", times.median),
                format!("{:.3} to {:.3}", times.low, times.high),
                apart(|row| row.rebuild_ms),
                apart(|row| row.query_ms),
                format!("{:.0}", row.visited),
                row.missed.to_string(),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![charts::medians(rows), charts::figure_7(rows)]
    }
}

/// The paper's runs.
fn published() -> Vec<Row> {
    let lines = PUBLISHED
        .lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1);
    lines
        .flat_map(|line| {
            let cells: Vec<f64> = line
                .split(',')
                .filter_map(|cell| cell.parse().ok())
                .collect();
            let row = |volume: &str, ms: f64| Row {
                run: cells[0] as u32,
                volume: volume.into(),
                rule: IN_PRINT.into(),
                ms,
                visited: 0.0,
                contacts: 0,
                missed: 0,
                rebuild_ms: 0.0,
                query_ms: 0.0,
                false_contacts: 0,
            };
            [row("spheres", cells[1]), row("AABBs", cells[2])]
        })
        .collect()
}

/// Each volume and rule, in the order in which they appear.
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

fn spread(rows: &[Row], volume: &str, rule: &str) -> Spread {
    let times: Vec<f64> = of(rows, volume, rule).map(|row| row.ms).collect();
    Spread::of(&times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn table1_is_complete_and_misses_nothing() {
        let rows = quick::<Table1>(View::Nothing, "run,volume,rule,ms");
        assert!(
            rows.iter()
                .all(|row| row.rule == IN_PRINT || row.contacts > 0)
        );
        assert!(
            (median(
                &of(&rows, "spheres", IN_PRINT)
                    .map(|row| row.ms)
                    .collect::<Vec<_>>()
            ) - 235.76)
                .abs()
                < 5.0
        );
    }
}
