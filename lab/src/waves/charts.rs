//! What is drawn of it.

use super::{MEMBRANE, Row, STRIP};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    measure::distinct,
};

/// Names of the panels, and which rows are in each.
pub const GROUPS: [(&str, fn(&Row) -> bool); 5] = [
    ("Hanging sheets, first mode", |row| is_hanging(row, 1)),
    ("Hanging sheets, second mode", |row| is_hanging(row, 2)),
    ("Hanging sheets, third mode", |row| is_hanging(row, 3)),
    ("Membrane, first mode", |row| row.scene == MEMBRANE),
    ("Taut strip: its sag", |row| row.scene == STRIP),
];

/// What is farther off than this is drawn on the edge (%).
const LOWEST: f64 = -5.0;
const HIGHEST: f64 = 10.0;

fn is_hanging(row: &Row, mode: usize) -> bool {
    row.scene.starts_with("hanging") && row.mode == mode
}

/// A panel a group: how far from true, by particles, in 20 sub-steps; and one by sub-steps.
pub fn all(rows: &[Row]) -> Chart {
    let shown = || rows.iter().filter(|row| row.substeps == 20);
    let worst = shown().max_by(|a, b| off(a).total_cmp(&off(b)));
    let title = worst.map_or("Periods against closed forms".into(), |row| {
        format!(
            "At 20 sub-steps periods and sags are {:.3} to {:.3} of the closed form; farthest: {}, mode {}, {} particles",
            shown().map(Row::ratio).fold(f64::INFINITY, f64::min),
            shown().map(Row::ratio).fold(0.0, f64::max),
            row.scene,
            row.mode,
            row.particles
        )
    });
    let mut chart = Chart::new(
        "waves",
        title,
        "How much longer a period, or deeper a sag, is than by the closed form. 20 sub-steps, all else by default; in the last panel every number of sub-steps, for the finest of each scene and its highest mode. By themselves cloths so taut get more: the membrane of 4,225 is 0.1 % off then. What is beyond 10 % lies on the edge.",
    )
    .sized([960, 1060])
    .columns(2);
    let y = || Axis::linear("off the closed form, %").between(LOWEST, HIGHEST);
    let point = |row: &Row, x: f64| [x, (100.0 * (row.ratio() - 1.0)).clamp(LOWEST, HIGHEST)];
    let scenes = distinct(rows.iter().map(|row| row.scene.as_str()));
    for (name, is_of) in GROUPS {
        let mut panel = Panel::new(name, Axis::log("particles, log"), y());
        for (style, scene) in scenes.iter().enumerate() {
            let points = shown().filter(|row| is_of(row) && row.scene == *scene);
            let points: Vec<_> = points.map(|row| point(row, row.particles as f64)).collect();
            if !points.is_empty() {
                panel = panel.with(Series::new(
                    *scene,
                    Look::Style(style),
                    Kind::Marked,
                    points,
                ));
            }
        }
        chart = chart.with(with_truth(panel, shown().filter(|row| is_of(row)), |row| {
            row.particles as f64
        }));
    }
    let mut panel = Panel::new("The finest, by sub-steps", Axis::log("sub-steps, log"), y());
    for (style, scene) in scenes.into_iter().enumerate() {
        let of = || rows.iter().filter(|row| row.scene == scene);
        let finest = of().map(|row| (row.particles, row.mode)).max();
        let points = of().filter(|row| Some((row.particles, row.mode)) == finest);
        let points = points.map(|row| point(row, f64::from(row.substeps)));
        panel = panel.with(Series::new(scene, Look::Style(style), Kind::Marked, points));
    }
    chart.with(with_truth(panel, rows.iter(), |row| {
        f64::from(row.substeps)
    }))
}

/// With a line at 0.
fn with_truth<'a>(
    panel: Panel,
    rows: impl Iterator<Item = &'a Row> + Clone,
    x: fn(&Row) -> f64,
) -> Panel {
    let ends = [
        rows.clone().map(x).fold(f64::INFINITY, f64::min),
        rows.map(x).fold(0.0, f64::max),
    ];
    let line = ends.map(|x| [x, 0.0]);
    panel.with(Series::new("closed form", Look::Ink, Kind::Line, line))
}

/// How far from true, as a factor's logarithm.
fn off(row: &Row) -> f64 {
    row.ratio().ln().abs()
}
