//! What is drawn of it.

use super::{
    DEV, Row, apps, depth, entities, get,
    search::{self, REFIT, REST_SHAPE, SCAN, SCENES},
    substepping::{self, SCENE as SWING},
};
use crate::chart::{Axis, Chart, Kind, Look, Panel, Point, Series};

/// A group of choices a panel.
pub fn all(rows: &[Row]) -> Chart {
    let ms = |scene, choice| get(rows, scene, choice).map_or(f64::NAN, |row| row.ms_per_tick);
    let (dragged, asleep) = (ms(apps::ONE, apps::TOUCHING), ms(apps::ONE, apps::ASLEEP));
    let (entities, columns) = (
        ms(entities::SCENE, entities::ENTITIES),
        ms(entities::SCENE, entities::SCALAR),
    );
    let build = if rows.iter().any(|row| row.build == DEV) {
        " A dev build: Bevy's own code, and so entities, would be several times as fast in a release build."
    } else {
        ""
    };
    Chart::new(
        "needs",
        format!(
            "Not needed, not paid for: a sleeping cloth takes 1/{:.0} of a dragged one, 100 cloths of which 1 moves 1/{:.0} of all awake, a scalar loop over columns 1/{:.0} of entities",
            dragged / asleep,
            ms(apps::HUNDRED, apps::ALL_AWAKE) / ms(apps::HUNDRED, apps::ONE_TOUCHED),
            entities / columns
        ),
        format!("Time of a tick and, beside each point, the error that this choice makes. Medians and quartiles; the axes differ. What columns gain over entities is storage in the scalar loop, vectorising beyond that.{build}"),
    )
    .sized([960, 1060])
    .columns(2)
    .with(dots(
        rows,
        apps::ONE,
        "One cloth of 64²: particles left inside of the ball",
        |error| format!("{error:.0}"),
    ))
    .with(dots(
        rows,
        apps::HUNDRED,
        "100 cloths of 16²: particles left inside",
        |error| format!("{error:.0}"),
    ))
    .with(dots(rows, SWING, "A fall, a calm, a gust, 32²: largest stretch", |error| {
        format!("{:.2} %", 100.0 * error)
    }))
    .with(searches(rows))
    .with(narrow(rows))
    .with(dots(
        rows,
        entities::SCENE,
        "32²: RMS distance to the solver after 1 s",
        |error| {
            if error == 0.0 {
                "–".into()
            } else {
                format!("{:.2} mm", 1.0e3 * error)
            }
        },
    ))
}

fn point(row: &Row, at: usize) -> Point {
    Point {
        at: [row.ms_per_tick, at as f64],
        across: Some([row.ms_low, row.ms_high]),
        up: None,
    }
}

/// From the slowest tick to the fastest with room for what is written to the right.
fn time_axis<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Axis {
    let low = rows
        .clone()
        .map(|row| row.ms_low)
        .fold(f64::INFINITY, f64::min);
    let high = rows.map(|row| row.ms_high).fold(0.0, f64::max);
    let wide = (high / low).max(2.0);
    Axis::log("ms a tick, log").between(low / wide.powf(0.1), high * wide.powf(0.35))
}

/// All choices of a scene, the first above.
fn dots(rows: &[Row], scene: &str, title: &str, error: fn(f64) -> String) -> Panel {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.scene == scene).rev().collect();
    let names = rows.iter().map(|row| row.choice.clone());
    let mut panel = Panel::new(
        title,
        time_axis(rows.iter().copied()),
        Axis::of_names("", names),
    );
    for (at, row) in rows.iter().enumerate() {
        panel = panel.note([row.ms_high, at as f64], error(row.error));
    }
    // Tolerances stand out from fixed numbers; what they are is beside them.
    let is_held = |row: &Row| {
        substepping::TOLERANCES
            .iter()
            .any(|(name, _)| *name == row.choice)
    };
    for (held, style) in [(false, 0), (true, 6)] {
        let points = rows
            .iter()
            .enumerate()
            .filter(|(_, row)| is_held(row) == held);
        let points = points.map(|(at, row)| point(row, at));
        panel = panel.with(Series::new("", Look::Style(style), Kind::Points, points));
    }
    panel
}

/// Three searches a scene; what they miss is in the title.
fn searches(rows: &[Row]) -> Panel {
    let of = |scene: &str, choice: &str| get(rows, scene, choice);
    let shown = rows
        .iter()
        .filter(|row| SCENES.iter().any(|(name, ..)| *name == row.scene));
    let wrong: f64 = shown.clone().map(|row| row.error).sum();
    let scenes: Vec<&str> = SCENES.iter().rev().map(|(name, ..)| *name).collect();
    let mut panel = Panel::new(
        format!("Search alone: {wrong:.0} contacts missed or imagined"),
        time_axis(shown),
        Axis::of_names("", scenes.iter().copied()),
    );
    for (choice, style) in [(SCAN, 1), (REST_SHAPE, 2), (REFIT, 3)] {
        let points = scenes
            .iter()
            .enumerate()
            .filter_map(|(at, scene)| Some(point(of(scene, choice)?, at)));
        panel = panel.with(Series::new(
            choice,
            Look::Style(style),
            Kind::Points,
            points,
        ));
    }
    panel
}

/// Both narrow phases a ball.
fn narrow(rows: &[Row]) -> Panel {
    let scenes: Vec<&str> = search::BALLS.iter().rev().map(|(name, _)| *name).collect();
    let shown = rows
        .iter()
        .filter(|row| scenes.contains(&row.scene.as_str()));
    let mut panel = Panel::new(
        "Response to a ball: depth, % of its radius",
        time_axis(shown),
        Axis::of_names("", scenes.iter().copied()),
    );
    for (choice, style) in [(search::PARTICLES, 4), (search::TRIANGLES, 5)] {
        let found = scenes.iter().enumerate();
        let found = found.filter_map(|(at, scene)| Some((at, get(rows, scene, choice)?)));
        for (at, row) in found.clone() {
            panel = panel.note([row.ms_high, at as f64], depth(row.error));
        }
        let points = found.map(|(at, row)| point(row, at));
        let name = format!("tested against {choice}");
        panel = panel.with(Series::new(name, Look::Style(style), Kind::Points, points));
    }
    panel
}
