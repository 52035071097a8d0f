//! Time against error, and against the largest stretch.

use super::{
    Row,
    frontier::{Depths, Group, mm},
    methods::METHODS,
    scenes::STIFF_SWINGING,
};
use crate::chart::{Axis, Chart, Kind, Look, Panel, Point, Series, number};

pub fn all(rows: &[Row]) -> Vec<Chart> {
    let mut charts = vec![errors(rows), stretches(rows)];
    charts.extend(depths(rows));
    charts
}

/// The panels: one a scene, with the largest cloths.
fn shown(rows: &[Row]) -> Vec<Group<'_>> {
    let mut groups = Group::largest(rows);
    groups.retain(|group| group.first().scene != STIFF_SWINGING);
    groups
}

fn conditions(groups: &[Group]) -> String {
    let side = groups
        .first()
        .map_or(0.0, |group| (group.first().particles as f64).sqrt());
    format!(
        "Cloths of {side}² particles, hung by their top row for a second. Peers are plain scalar code, ours is the plugin's solver, all on one thread."
    )
}

fn heading(group: &Group) -> String {
    // In millimetres, without the noise of single precision.
    let compliance = (1.0e6 * f64::from(group.first().compliance)).round() / 1.0e3;
    format!(
        "{}, compliance {} mm/N",
        group.first().scene,
        number(compliance)
    )
}

fn point(row: &Row, value: f64) -> Point {
    Point {
        at: [row.ms_per_second, value],
        across: Some([row.ms_low, row.ms_high]),
        up: None,
    }
}

/// From the left to the right end of what is drawn.
fn level(group: &Group, value: f64) -> [[f64; 2]; 2] {
    let times = || group.rows().iter().map(|row| row.ms_per_second);
    let ends = [
        times().fold(f64::INFINITY, f64::min),
        times().fold(0.0, f64::max),
    ];
    ends.map(|time| [time, value])
}

fn errors(rows: &[Row]) -> Chart {
    let groups = shown(rows);
    let ratios: Vec<f64> = groups
        .iter()
        .filter_map(Group::default_against_peers)
        .map(|(ours, peer)| peer.ms_per_second / ours.ms_per_second)
        .collect();
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let most = ratios.iter().copied().fold(0.0, f64::max);
    let exact = groups
        .iter()
        .filter(|group| group.peer_is_most_exact())
        .count();
    let title = format!(
        "As exact as our 20 sub-steps, the fastest peer takes {least:.1} to {most:.1} × as long; in {exact} of {} scenes a peer is the most exact of all",
        groups.len()
    );
    let conditions = conditions(&groups);
    let mut chart = Chart::new(
        "pareto",
        title,
        format!("{conditions} The same marker in grey: another setting is faster and at least as exact. No error is drawn below the reference's own."),
    )
    .sized([960, 1300])
    .columns(2);
    let is_shown_best = |method: &str| {
        groups
            .iter()
            .any(|group| group.frontier().iter().any(|row| row.method == method))
    };
    for group in &groups {
        let frontier = group.frontier();
        let mut panel = Panel::new(
            heading(group),
            Axis::log("ms a simulated second, log"),
            Axis::log("RMS position error (mm), log"),
        );
        let line = frontier
            .iter()
            .map(|row| [row.ms_per_second, 1.0e3 * row.error()]);
        panel = panel.with(Series::new(
            "what nothing beats",
            Look::Grey,
            Kind::Line,
            line,
        ));
        for best in [false, true] {
            for (style, method) in METHODS.into_iter().enumerate() {
                let look = if best {
                    Look::Style(style)
                } else {
                    Look::Faded(style)
                };
                let is_best = |row: &&Row| frontier.iter().any(|other| std::ptr::eq(*other, *row));
                let points = group.of(method).filter(|row| is_best(row) == best);
                let points = points.map(|row| point(row, 1.0e3 * row.error()));
                // A method that is nowhere among the best is named by its grey marker.
                let name = if best || !is_shown_best(method) {
                    method
                } else {
                    ""
                };
                panel = panel.with(Series::new(name, look, Kind::Points, points));
            }
        }
        let floor = level(group, 1.0e3 * group.first().reference_error_m);
        panel = panel.with(Series::new(
            "reference's own error",
            Look::Ink,
            Kind::Line,
            floor,
        ));
        chart = chart.with(panel);
    }
    chart
}

fn stretches(rows: &[Row]) -> Chart {
    let groups = shown(rows);
    // As good as true, and yet off.
    let deceiving = groups
        .iter()
        .flat_map(Group::rows)
        .filter(|row| (row.max_stretch - row.reference_stretch).abs() < 1.0e-3)
        .max_by(|a, b| a.error().total_cmp(&b.error()));
    let title = deceiving.map_or("Largest stretch against time".into(), |row| {
        format!(
            "True stretch is not true motion: {}, {}, has the true stretch of the {} cloth to 0.1 % of its length and is {} off",
            row.method,
            row.setting,
            row.scene,
            mm(row.error())
        )
    });
    let mut chart = Chart::new("pareto-stretch", title, conditions(&groups))
        .sized([960, 1300])
        .columns(2);
    for group in &groups {
        let mut panel = Panel::new(
            heading(group),
            Axis::log("ms a simulated second, log"),
            Axis::log("largest stretch (%), log"),
        );
        panel = methods(panel, group, |row| 100.0 * row.max_stretch);
        let truth = level(group, 100.0 * group.first().reference_stretch);
        panel = panel.with(Series::new("the reference's", Look::Ink, Kind::Line, truth));
        chart = chart.with(panel);
    }
    chart
}

/// All methods over time, by what is asked for.
fn methods(mut panel: Panel, group: &Group, value: impl Fn(&Row) -> f64) -> Panel {
    for (style, method) in METHODS.into_iter().enumerate() {
        // One step a tick, and several: each a line.
        for is_split in [false, true] {
            let points = group
                .of(method)
                .filter(|row| row.setting.contains('×') == is_split)
                .map(|row| point(row, value(row)));
            let look = Look::Style(style);
            panel = panel.with(Series::new(method, look, Kind::Marked, points));
        }
    }
    panel
}

fn depths(rows: &[Row]) -> Option<Chart> {
    let Depths {
        group,
        ours,
        deepest,
        ..
    } = Depths::of(rows)?;
    let title = format!(
        "By 20 sub-steps of ours particles are found at most {} deep in the ball; by {} with {}, {}",
        mm(ours.max_penetration_m),
        deepest.method,
        deepest.setting,
        mm(deepest.max_penetration_m)
    );
    let panel = Panel::new(
        heading(&group),
        Axis::log("ms a simulated second, log"),
        Axis::log("deepest before it is pushed out (mm), log"),
    );
    let panel = methods(panel, &group, |row| 1.0e3 * row.max_penetration_m);
    let groups = [group];
    Some(Chart::new("pareto-penetration", title, conditions(&groups)).with(panel))
}
