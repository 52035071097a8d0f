//! How the search and the whole tick grow with the cloth: from 8 × 8 to 1024 × 1024 particles.
//!
//! A draped cloth, two waves across it, and a ball of 4 spacings that touches it. All volumes and rules, the scan, brute
//! force and parry's tree take their turns, and in each turn the solver does a tick: 20 sub-steps with the response to
//! the ball. A search's whole tick is that and its own rebuild and query: without tethers and without the plugin's other
//! systems. The largest stretch, which the rest shape needs, is measured in the solver's last sub-step, and so is part of
//! every search's tick; it is timed apart as well.

mod charts;
mod searchers;

use bevy_drape::hierarchy::{BoundRule, TopDownQuery, brute_force};
use serde::{Deserialize, Serialize};

use crate::{
    chart::{Chart, number},
    cloths::CHOICES,
    draped::Draped,
    experiment::{Experiment, Run, Table},
    measure::{Spread, exponent, median, seconds_each},
};
use searchers::{BRUTE, PARRY, SCAN, Searcher, Ticking};

/// Exponents are of cloths from this side on: smaller ones are all waves, and fit into a cache.
const FITTED_FROM: u32 = 32;

/// How long something short is done again and again (s).
const MIN: f64 = 2.0e-4;

pub struct Scaling;

/// One way to search a cloth of one size.
#[derive(Serialize, Deserialize)]
pub struct Row {
    particles: u32,
    volume: String,
    rule: String,
    rebuild_us: f64,
    query_us: f64,
    /// The solver's 20 sub-steps with response, and both of the above.
    tick_us: f64,
    rebuild_low: f64,
    rebuild_high: f64,
    query_low: f64,
    query_high: f64,
    tick_low: f64,
    tick_high: f64,
    /// Nodes, or particles where there is no tree; 0 where that is not known.
    visited: usize,
    contacts: usize,
    missed: usize,
    /// Largest stretch of the cloth.
    stretch: f32,
    /// What it takes to measure that apart, whoever searches.
    stretch_us: f64,
    /// Found, but not by brute force.
    false_contacts: usize,
}

impl Row {
    fn side(&self) -> u32 {
        self.particles.isqrt()
    }

    fn search_us(&self) -> f64 {
        self.rebuild_us + self.query_us
    }
}

impl Experiment for Scaling {
    type Row = Row;

    const NAME: &'static str = "scaling";

    fn run(run: &mut Run) -> Vec<Row> {
        let sides = run.either(
            &[8, 16, 32, 64, 128, 256][..],
            &[8, 16, 32, 64, 128, 256, 512, 1024],
        );
        let turns = run.either(3, 11);
        run.set("scene", "a draped cloth, two waves across it and three spacings high, spacing 0.05 m, and a ball of 4 spacings that touches it");
        run.set("turns", turns);
        run.set(
            "rebuild and query",
            "timed hot: each again and again until 0.2 ms have passed",
        );
        run.set("tick", "the solver's 20 sub-steps of 1/64 s on one thread, with response, without tethers and without the plugin's other systems: measured once a turn, and each search's rebuild and query added to it");
        run.set("stretch_us", "the largest stretch, measured apart and hot; the rest shape needs it, and every rule's tick has it in the solver's last sub-step");
        let mut rows = Vec::new();
        run.begin(Self::NAME, sides.len() * turns);
        for &side in sides {
            let draped = Draped::new(side);
            let ball = draped.ball();
            let truth = brute_force(&draped.particles, &ball);
            let mut query = TopDownQuery::default();
            let mut ticking = Ticking::new(&draped, side);
            let mut searchers = Searcher::all(&draped);
            let mut times = vec![[const { Vec::new() }; 3]; searchers.len()];
            let mut stretch_us = Vec::new();
            for _ in 0..turns {
                let solver = ticking.seconds(&draped, &ball);
                stretch_us.push(1.0e6 * ticking.stretch_seconds(MIN, &draped));
                for (searcher, times) in searchers.iter_mut().zip(&mut times) {
                    let rebuild = if searcher.has_rebuild() {
                        seconds_each(MIN, || searcher.rebuild(&draped))
                    } else {
                        0.0
                    };
                    let search = seconds_each(MIN, || searcher.search(&mut query, &draped, &ball));
                    let all = [rebuild, search, solver + rebuild + search];
                    for (times, seconds) in times.iter_mut().zip(all) {
                        times.push(1.0e6 * seconds);
                    }
                }
                run.step();
            }
            for (searcher, times) in searchers.iter().zip(&times) {
                let [missed, false_contacts] =
                    searcher.missed_and_false(&mut query, &draped, &ball, &truth);
                let visited = match searcher {
                    Searcher::Parry(_) => 0,
                    Searcher::Brute => draped.particles.len(),
                    _ => query.nodes_visited().max(query.leaf_tests()),
                };
                let [rebuild, search, tick] = times.each_ref().map(|times| Spread::of(times));
                let [volume, rule] = searcher.names().map(String::from);
                rows.push(Row {
                    particles: side * side,
                    volume,
                    rule,
                    rebuild_us: rebuild.median,
                    query_us: search.median,
                    tick_us: tick.median,
                    rebuild_low: rebuild.low,
                    rebuild_high: rebuild.high,
                    query_low: search.low,
                    query_high: search.high,
                    tick_low: tick.low,
                    tick_high: tick.high,
                    visited,
                    contacts: truth.len(),
                    missed,
                    stretch: draped.stretch,
                    stretch_us: median(&stretch_us),
                    false_contacts,
                });
            }
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for row in rows {
            if row.missed > 0 && row.rule != BoundRule::Paper.name() {
                return Err(format!(
                    "{} by {} missed {} of {} contacts at {}²",
                    row.volume,
                    row.rule,
                    row.missed,
                    row.contacts,
                    row.side()
                ));
            }
            if row.false_contacts > 0 {
                return Err(format!(
                    "{} by {} imagined {} contacts at {}²",
                    row.volume,
                    row.rule,
                    row.false_contacts,
                    row.side()
                ));
            }
            if row.contacts == 0 {
                return Err(format!("the ball does not touch at {}²", row.side()));
            }
        }
        let sides = sides(rows);
        let is_whole = sides.len() >= 6 && rows.len() == sides.len() * (CHOICES.len() + 3);
        if !is_whole {
            return Err("13 searches of each of at least 6 sizes".into());
        }
        // What a search looks at, not how long it takes: that is the machine's.
        let grows = |kind| fitted(rows, kind, |row| row.visited as f64);
        let (rest, scan) = (grows(REST), grows(["particles", SCAN]));
        if rest < 0.3 && scan > 0.99 {
            Ok(())
        } else {
            Err(format!(
                "nodes visited grow as n^{rest:.2} by the rest shape, as n^{scan:.2} by a scan"
            ))
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let search = |kind| fitted(rows, kind, Row::search_us);
        let sides = sides(rows);
        let [smallest, largest] = [sides.first(), sides.last()].map(|side| *side.unwrap_or(&0));
        let us = |kind, side| at(rows, kind, side).map_or(f64::NAN, Row::search_us);
        let [scan, parry, brute] = [["particles", SCAN], ["AABBs", PARRY], ["particles", BRUTE]];
        let share = |kind| {
            at(rows, kind, largest).map_or(f64::NAN, |row| 100.0 * row.search_us() / row.tick_us)
        };
        let mut findings = vec![
            format!(
                "By the rest shape, spheres are searched in {:.1} µs at {smallest}² and in {:.1} µs at {largest}²: as n^{:.2} from {FITTED_FROM}² on, where refitted spheres and AABBs take n^{:.2} and n^{:.2}, a scan n^{:.2}, parry3d n^{:.2} and the tick, the solver's 20 sub-steps without tethers and the plugin's other systems, n^{:.2}. Queries are timed hot, one after the other.",
                us(REST, smallest),
                us(REST, largest),
                search(REST),
                search(REFIT_SPHERES),
                search(REFIT),
                search(scan),
                search(parry),
                fitted(rows, REST, |row| row.tick_us),
            ),
            beats_scan(rows),
            format!(
                "At {largest}² the rest shape is {} × as fast as a scan, {} × as brute force in f64, {} × as a refit of AABBs and {} × as parry3d; of a tick of 20 sub-steps it is {:.4} %, a scan {:.1} %, parry3d {:.0} %.",
                times(us(scan, largest) / us(REST, largest)),
                times(us(brute, largest) / us(REST, largest)),
                times(us(REFIT, largest) / us(REST, largest)),
                times(us(parry, largest) / us(REST, largest)),
                share(REST),
                share(scan),
                share(parry),
            ),
        ];
        if let Some(rest) = at(rows, REST, largest) {
            findings.push(format!(
                "That does not count the largest stretch, which the rest shape needs: it is measured in the solver's last sub-step, in every rule's tick. Apart and hot, that takes {:.1} µs at {largest}², {:.2} % of the tick and {} × as long as the rest shape's own rebuild and query, where a whole scan takes {:.1} µs, and refit and query of AABBs {:.1} µs.",
                rest.stretch_us,
                100.0 * rest.stretch_us / rest.tick_us,
                times(rest.stretch_us / rest.search_us()),
                us(scan, largest),
                us(REFIT, largest),
            ));
        }
        if let [Some(rest), Some(refit)] = [REST, REFIT].map(|kind| at(rows, kind, largest)) {
            let saved = rest.query_us - refit.query_us;
            findings.push(format!(
                "Its price is looser volumes: {} nodes visited where refitted AABBs visit {}, and a query of {:.1} µs for {:.1}; the refit of {:.0} µs {}.",
                rest.visited,
                refit.visited,
                rest.query_us,
                refit.query_us,
                refit.rebuild_us,
                if saved > 0.0 {
                    format!("would pay from some {:.0} balls a tick on", refit.rebuild_us / saved)
                } else {
                    "never pays".into()
                }
            ));
        }
        let lost = of(rows, ["spheres", BoundRule::Paper.name()])
            .filter(|row| row.missed > 0)
            .map(|row| format!("{} of {} at {}²", row.missed, row.contacts, row.side()));
        let lost: Vec<String> = lost.collect();
        findings.push(if lost.is_empty() {
            "The paper's spheres are not drawn; at these sizes they lose no contacts.".into()
        } else {
            format!(
                "The paper's spheres are not drawn, since they prune what the ball touches; they lose contacts at {1} of {2} sizes: {0}.",
                lost.join(", "),
                lost.len(),
                sides.len()
            )
        });
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "volume",
            "rule",
            "n",
            "rebuild µs",
            "query µs",
            "tick µs",
            "visited",
            "missed",
        ]);
        for row in rows {
            table.row([
                row.volume.clone(),
                row.rule.clone(),
                format!("{}²", row.side()),
                format!("{:.2}", row.rebuild_us),
                format!("{:.2}", row.query_us),
                format!("{:.1}", row.tick_us),
                row.visited.to_string(),
                row.missed.to_string(),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![charts::growth(rows), charts::parts(rows)]
    }
}

/// From which size on the rest shape is searched faster than all particles are scanned.
fn beats_scan(rows: &[Row]) -> String {
    let sides = sides(rows);
    let faster = |side: u32| {
        let rest = at(rows, REST, side)?.search_us();
        Some(at(rows, ["particles", SCAN], side)?.search_us() / rest)
    };
    let first = sides
        .iter()
        .find(|&&side| faster(side).is_some_and(|ratio| ratio > 1.0));
    let Some(&first) = first else {
        return "At every size measured a scan of all particles is faster than the tree.".into();
    };
    let below = sides.iter().rfind(|&&side| side < first);
    match below.and_then(|&side| Some((side, faster(side)?))) {
        Some((side, ratio)) => format!(
            "Below {first}² the scan wins, at {side}² by {:.1} ×; from {first}² on, where it takes {:.1} × as long, the tree does.",
            1.0 / ratio,
            faster(first).unwrap_or(f64::NAN)
        ),
        None => "The tree is faster than a scan at every size measured.".into(),
    }
}

type Names = [&'static str; 2];

const REST: Names = ["spheres", "rest shape"];
const REFIT_SPHERES: Names = ["spheres", "refit"];
const REFIT: Names = ["AABBs", "refit"];

/// Exponent of the particles in a figure, from [`FITTED_FROM`] on.
fn fitted(rows: &[Row], kind: Names, value: impl Fn(&Row) -> f64) -> f64 {
    exponent_from(of(rows, kind).map(|row| [f64::from(row.particles), value(row)]))
}

/// With two digits that say something.
fn times(ratio: f64) -> String {
    let unit = 10f64.powf(ratio.log10().floor() - 1.0).max(0.1);
    number((ratio / unit).round() * unit)
}

fn exponent_from(points: impl Iterator<Item = [f64; 2]>) -> f64 {
    let least = f64::from(FITTED_FROM * FITTED_FROM);
    let points: Vec<[f64; 2]> = points
        .filter(|[particles, _]| *particles >= least)
        .collect();
    // Rounded as it is said: no minus before nothing.
    (100.0 * exponent(&points)).round() / 100.0 + 0.0
}

fn sides(rows: &[Row]) -> Vec<u32> {
    let mut sides: Vec<u32> = rows.iter().map(Row::side).collect();
    sides.dedup();
    sides
}

fn of(rows: &[Row], [volume, rule]: Names) -> impl Iterator<Item = &Row> {
    rows.iter()
        .filter(move |row| row.volume == volume && row.rule == rule)
}

fn at(rows: &[Row], kind: Names, side: u32) -> Option<&Row> {
    of(rows, kind).find(|row| row.side() == side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn scaling_is_complete_and_the_rest_shape_hardly_grows() {
        let rows = quick::<Scaling>(
            View::Nothing,
            "particles,volume,rule,rebuild_us,query_us,tick_us,",
        );
        assert!(
            rows.iter()
                .all(|row| row.query_us > 0.0 && row.tick_us >= row.query_us)
        );
        assert!(rows.iter().all(|row| row.query_low <= row.query_high));
    }
}
