//! What is drawn of it.

use super::{
    FITTED_FROM, Names, REFIT, REST, Row, at, exponent_from, fitted, of,
    searchers::{PARRY, SCAN},
    sides, times,
};
use crate::chart::{Axis, Chart, Kind, Look, Panel, Point, Series};

/// What is drawn: the others lie between these.
const SHOWN: [(Names, usize); 6] = [
    (REST, 0),
    (["particles", SCAN], 1),
    (REFIT, 2),
    (["26-DOPs", "refit"], 3),
    (["OBBs", "refit"], 4),
    (["AABBs", PARRY], 5),
];

/// How rebuild and query grow, and which part of the tick they are.
pub fn growth(rows: &[Row]) -> Chart {
    let called = |kind: Names| {
        let grows = fitted(rows, kind, Row::search_us);
        let name = match kind {
            ["particles", rule] => rule.into(),
            [_, PARRY] => PARRY.into(),
            [volume, rule] => format!("{volume}, {rule}"),
        };
        format!("{name}: n^{grows:.2}")
    };
    let mut search = Panel::new(
        "Rebuild and query",
        particles_axis(rows),
        Axis::log("µs a tick, log"),
    );
    let mut part = Panel::new(
        "Their part of the whole tick",
        particles_axis(rows),
        Axis::log("% of the tick, log"),
    );
    for (kind, style) in SHOWN {
        let at = |row: &Row, median: f64| [f64::from(row.particles), median];
        let points = of(rows, kind).map(|row| Point {
            at: at(row, row.search_us()),
            across: None,
            up: Some([
                row.rebuild_low + row.query_low,
                row.rebuild_high + row.query_high,
            ]),
        });
        let look = Look::Style(style);
        search = search.with(Series::new(called(kind), look, Kind::Marked, points));
        let parts = of(rows, kind).map(|row| at(row, 100.0 * row.search_us() / row.tick_us));
        part = part.with(Series::new(called(kind), look, Kind::Marked, parts));
    }
    let solver =
        || of(rows, REST).map(|row| [f64::from(row.particles), row.tick_us - row.search_us()]);
    let name = format!("20 sub-steps: n^{:.2}", exponent_from(solver()));
    search = search.with(Series::new(name, Look::Ink, Kind::Line, solver()));
    let sides = sides(rows);
    let [smallest, largest] = [sides.first(), sides.last()].map(|side| *side.unwrap_or(&0));
    let us = |kind| at(rows, kind, largest).map_or(f64::NAN, Row::search_us);
    let all = || of(rows, REST).map(Row::search_us);
    Chart::new(
        "scaling",
        format!(
            "From {smallest}² to {largest}² the rest shape takes {:.1} to {:.1} µs; at {largest}² a scan takes {} × as long, parry3d {} ×",
            all().fold(f64::INFINITY, f64::min),
            all().fold(0.0, f64::max),
            times(us(["particles", SCAN]) / us(REST)),
            times(us(["AABBs", PARRY]) / us(REST))
        ),
        format!("A draped cloth, one ball of 4 spacings, one thread; medians, quartiles. Queries are timed hot; the tick is the solver's 20 sub-steps without tethers and the plugin's other systems, and every rule's has the measuring of the stretch that the rest shape needs in its last sub-step. In the legend, how the time grows with n particles, from {FITTED_FROM}² on."),
    )
    .sized([960, 600])
    .columns(2)
    .with(search)
    .with(part)
}

/// Rebuild, query and nodes apart.
pub fn parts(rows: &[Row]) -> Chart {
    let panel = |title: &str, label: &str, value: fn(&Row) -> f64| {
        let mut panel = Panel::new(title, particles_axis(rows), Axis::log(label));
        for (kind, style) in SHOWN {
            let [volume, rule] = kind;
            let points = of(rows, kind).map(|row| [f64::from(row.particles), value(row)]);
            panel = panel.with(Series::new(
                format!("{volume}, {rule}"),
                Look::Style(style),
                Kind::Marked,
                points,
            ));
        }
        panel
    };
    let largest = sides(rows).last().copied().unwrap_or(0);
    let visited = |kind| at(rows, kind, largest).map_or(0, |row| row.visited);
    Chart::new(
        "scaling-parts",
        format!(
            "A refit pays for tight volumes: {} nodes visited in place of {}, and all of them brought up to date",
            visited(REFIT),
            visited(REST)
        ),
        "The same scene: what it takes to bring the volumes up to date, what one query takes, and how many nodes (or particles) it looks at. A scan has nothing to rebuild; what parry3d looks at is not known.",
    )
    .sized([960, 480])
    .columns(3)
    .with(panel("Rebuild", "µs, log", |row| row.rebuild_us))
    .with(panel("One query", "µs, log", |row| row.query_us))
    .with(panel("Nodes visited", "nodes, log", |row| {
        row.visited as f64
    }))
}

/// Every second size is named, the largest among them.
fn particles_axis(rows: &[Row]) -> Axis {
    let names = sides(rows)
        .into_iter()
        .rev()
        .step_by(2)
        .map(|side| (f64::from(side * side), format!("{side}²")));
    Axis::log("particles, log").named(names)
}
