//! What is drawn of it.

use super::{
    NOTHING, Row, TRIANGLES,
    compared::{self, FASTEST},
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    measure::distinct,
};

/// What contact adds to a tick, and how many intersections are left, both against the speed.
pub fn all(rows: &[Row]) -> Chart {
    let moved = || rows.iter().filter(|row| !row.is_cost());
    let scenes = distinct(moved().map(|row| (row.scene.clone(), row.particles)));
    let mut lost = Panel::new(
        "What passes through",
        Axis::log("speed (m/s), log"),
        Axis::linear("ticks with an intersection (%)").between(0.0, 100.0),
    );
    let mut cost = Panel::new(
        "What it costs",
        Axis::log("speed (m/s), log"),
        Axis::log("times the tick without, log"),
    );
    for (style, (scene, particles)) in scenes.iter().enumerate() {
        let of = |choice: &'static str| {
            let of = moved().filter(move |row| {
                row.scene == *scene && row.particles == *particles && row.choice == choice
            });
            let speeds = distinct(of.clone().map(|row| row.speed.to_bits()));
            let each = speeds.into_iter().map(move |bits| {
                let same = of.clone().filter(move |row| row.speed.to_bits() == bits);
                (f64::from(f32::from_bits(bits)), same.collect::<Vec<_>>())
            });
            each.collect::<Vec<_>>()
        };
        let name = format!("{scene}, {particles}");
        let share = of(TRIANGLES).into_iter().map(|(speed, rows)| {
            let with: usize = rows.iter().map(|row| row.ticks_with).sum();
            let all: usize = rows.iter().map(|row| row.ticks).sum();
            [speed, 100.0 * with as f64 / all as f64]
        });
        let share = share.collect::<Vec<_>>();
        lost.series.push(Series::new(
            name.as_str(),
            Look::Style(style),
            Kind::Marked,
            share,
        ));
        let times = of(TRIANGLES).into_iter().map(|(speed, rows)| {
            let sum: f64 = rows.iter().map(|row| 1.0 + row.added()).sum();
            [speed, sum / rows.len() as f64]
        });
        let times = times.collect::<Vec<_>>();
        cost.series
            .push(Series::new(name, Look::Style(style), Kind::Marked, times));
    }
    let runs = moved().filter(|row| row.choice == TRIANGLES);
    let clean = runs.clone().filter(|row| row.intersections == 0).count();
    let nothing = moved().find(|row| row.choice == NOTHING);
    let besides = nothing.map_or(String::new(), |row| {
        format!(
            " Without contact {} of {} ticks of a drop at {} m/s have some.",
            row.ticks_with, row.ticks, row.speed
        )
    });
    Chart::new(
        "self",
        format!(
            "In {clean} of {} runs no two triangles ever intersect",
            runs.count()
        ),
        format!("Cloth that touches itself and other cloth, 2 to 16 mm thick: ticks in which triangles intersect, counted by brute force in f64 after every tick, and the time of a tick over that of the same scene without such contact, both against the speed.{besides}"),
    )
    .sized([1280, 600])
    .columns(3)
    .with(lost)
    .with(cost)
    .with(choices(rows))
}

/// A mark for each choice and scene: what it costs against what passes through it, both up to a speed.
fn choices(rows: &[Row]) -> Panel {
    let mut panel = Panel::new(
        format!("Choices, drops up to {FASTEST} m/s"),
        Axis::log("times the tick without, log"),
        Axis::linear("ticks with an intersection (%)"),
    );
    for (style, choice) in compared::all(rows).into_iter().enumerate() {
        let slow = choice.only(|row| row.speed <= FASTEST);
        let scenes = distinct(slow.rows.iter().map(|row| row.scene.clone()));
        // The styles of scenes begin with the first.
        let look = Look::Style(7 - style);
        for scene in scenes {
            let same = slow.only(|row| row.scene == scene);
            let [with, all] = same.ticks();
            let times = same.times();
            // Where there is no response nothing is said of intersections: a line up.
            let (kind, points) = if all == 0 {
                (Kind::Line, vec![[times, 0.0], [times, 100.0]])
            } else {
                let share = 100.0 * with as f64 / all as f64;
                (Kind::Points, vec![[times, share]])
            };
            let name = choice.name.as_str();
            panel.series.push(Series::new(name, look, kind, points));
        }
    }
    panel
}
