//! What is drawn of it.

use super::{Row, groups, of, touching};
use crate::chart::{Axis, Chart, Kind, Look, Panel, Point, Series};

/// Ticks against the number of colliders that are far, and what a touched one costs by its shape.
pub fn all(rows: &[Row]) -> Chart {
    let groups = groups(rows);
    let many = groups.iter().map(|(cloths, _)| *cloths).max().unwrap_or(1);
    let mut one = Panel::new(
        "One cloth",
        Axis::log("colliders, all far, log"),
        Axis::log("ms a tick, log"),
    );
    let mut several = Panel::new(
        format!("{many} cloths"),
        Axis::log("colliders, all far, log"),
        Axis::log("ms a tick, log"),
    );
    // A state looks the same in both panels: the legend names each once.
    let states = crate::measure::distinct(groups.iter().map(|(_, state)| state));
    for (cloths, state) in &groups {
        let style = states.iter().position(|each| *each == state).unwrap_or(0);
        let points = of(rows, *cloths, state).map(|row| Point {
            at: [f64::from(row.colliders), row.ms_per_tick],
            across: None,
            up: Some([row.ms_low, row.ms_high]),
        });
        let with = Series::new(state.as_str(), Look::Style(style), Kind::Marked, points);
        let without =
            of(rows, *cloths, state).map(|row| [f64::from(row.colliders), row.ms_without]);
        let without = Series::new("the same without", Look::Faded(style), Kind::Line, without);
        let panel = if *cloths == many {
            &mut several
        } else {
            &mut one
        };
        panel.series.extend([with, without]);
    }
    let names = touching(rows).map(|row| row.shape.clone());
    let mut shapes = Panel::new(
        "One cloth that lies on one collider",
        Axis::linear("times the tick without contact"),
        Axis::of_names("", names),
    );
    let points = touching(rows).enumerate().map(|(at, row)| Point {
        at: [row.ms_per_tick / row.ms_without, at as f64],
        across: Some([row.ms_low / row.ms_without, row.ms_high / row.ms_without]),
        up: None,
    });
    shapes = shapes.with(Series::new("", Look::Style(0), Kind::Points, points));
    let most = rows
        .iter()
        .filter(|row| row.cloths == many && row.state.starts_with("awake"))
        .max_by_key(|row| row.colliders);
    let title = most.map_or("What colliders cost".into(), |row| {
        let percent = 100.0 * row.added() / row.ms_without;
        let added = match percent < 1.0 {
            true => "less than 1 %".into(),
            false => format!("{percent:.1} %"),
        };
        let [colliders, cloths] = [row.colliders, row.cloths];
        format!("{colliders} colliders that are far add {added} to a tick of {cloths} cloths")
    });
    Chart::new(
        "colliders",
        title,
        "All of the plugin's systems in a tick, on one thread, against the number of colliders, by whether cloths sleep and colliders move; and what one that is touched costs, by its shape. Medians and quartiles; the same cloths without colliders in the same turns.",
    )
    .sized([960, 860])
    .columns(2)
    .with(one)
    .with(several)
    .with(shapes)
}
