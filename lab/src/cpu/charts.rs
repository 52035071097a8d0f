//! The paper's Figure 10, and ours beside it.

use bevy_drape::hierarchy::BoundingVolume;

use super::{Figure, Row, adapter, frame_time, spheres_to_boxes, spread, utilisation};
use crate::chart::{Axis, Chart, Kind, Look, Panel, Point, Series};

/// How many times as much spheres took as AABBs in the paper: "about 15 %" more.
const PUBLISHED: f64 = 1.15;

/// The paper's Figure 10, of which only the difference was published, and the same here.
pub fn figure_10(rows: &[Row]) -> Chart {
    let names = BoundingVolume::ALL.map(|(name, _)| name);
    let largest = rows
        .iter()
        .map(|row| row.cpu_ms_per_frame)
        .fold(0.0, f64::max);
    let largest = if largest > 0.0 { largest } else { 1.0 };
    let mut each = Panel::new(
        "Each volume",
        Axis::linear("CPU time of a frame (ms)").between(0.0, 1.05 * largest),
        Axis::of_names("", names.iter().rev().copied()),
    );
    let looks = [
        (true, "drawn", Look::Style(0)),
        (false, "not drawn", Look::Style(1)),
    ];
    for (is_drawn, name, look) in looks {
        let points = names.iter().rev().enumerate();
        let points = points.map(|(place, &volume)| {
            let ms = spread(rows, (volume, is_drawn), frame_time);
            Point {
                at: [ms.median, place as f64],
                across: Some([ms.low, ms.high]),
                up: None,
            }
        });
        let points = points.filter(|point| point.at[0].is_finite());
        each = each.with(Series::new(name, look, Kind::Points, points));
    }
    let figures: [(&str, Figure); 2] = [
        ("CPU time a frame", frame_time),
        ("utilisation", utilisation),
    ];
    let mut names = Vec::new();
    let mut against = Vec::new();
    for (is_drawn, drawn, look) in looks.into_iter().rev() {
        for (figure, of) in figures {
            let ratio = spheres_to_boxes(rows, is_drawn, of);
            if ratio.median.is_finite() {
                against.push((names.len() as f64, ratio, look));
                names.push(format!("{figure}, {drawn}"));
            }
        }
    }
    let top = names.len() as f64;
    names.push("utilisation".into());
    let mut more = Panel::new(
        "Spheres against AABBs",
        Axis::linear("times as much"),
        Axis::of_names("", names),
    )
    .with(Series::new(
        "",
        Look::Ink,
        Kind::Line,
        [[1.0, -0.6], [1.0, top + 0.6]],
    ))
    .with(Series::new(
        "the paper, about",
        Look::Style(3),
        Kind::Points,
        [[PUBLISHED, top]],
    ));
    for (place, ratio, look) in against {
        let point = Point {
            at: [ratio.median, place],
            across: Some([ratio.low, ratio.high]),
            up: None,
        };
        more = more.with(Series::new("", look, Kind::Points, [point]));
    }
    let [used, time] = [utilisation, frame_time].map(|of| spheres_to_boxes(rows, true, of).median);
    let title = if time.is_finite() {
        format!(
            "Spheres drawn: {time:.2} × the CPU time of AABBs a frame, {used:.2} × the utilisation; paper {PUBLISHED} ×"
        )
    } else {
        let time = spheres_to_boxes(rows, false, frame_time).median;
        if time.is_finite() {
            format!("With nothing drawn, spheres take {time:.2} × the CPU time of AABBs")
        } else {
            "With nothing drawn, less of the CPU is taken than the system counts".into()
        }
    };
    let by = adapter(rows).map_or("nothing drawn".into(), |adapter| {
        format!("drawn by {adapter}")
    });
    Chart::new(
        "cpu",
        title,
        format!("The whole process, its scene at its real pace, {by}, into a small image. Median and quartiles of turns."),
    )
    .columns(2)
    .with(each)
    .with(more)
}
