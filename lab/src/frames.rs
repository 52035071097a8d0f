//! The paper's frame test: frames a second over its scene with the whole hierarchy drawn, by every volume, and not drawn.

use bevy_drape::hierarchy::BoundingVolume;
use examples_shared::view::View;
use serde::{Deserialize, Serialize};

use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Point, Series},
    drawn::{Drawn, WHOLE},
    experiment::{Experiment, Run, Table},
    measure::{Spread, distinct, median, seconds},
};

/// The paper's averages over its scene.
pub const PUBLISHED: [(&str, f64); 2] = [("spheres", 13.41), ("AABBs", 21.17)];

/// Frames in a row by one volume, after the first, which is thrown away.
const BLOCK: usize = 2;

pub struct Frames;

/// One frame.
#[derive(Serialize, Deserialize)]
pub struct Row {
    /// Of all that were drawn.
    frame: u32,
    volume: String,
    drawn: bool,
    fps: f64,
    /// All volumes take their turn in a round.
    round: u32,
    /// How far the scene has come (s).
    second: f64,
    /// Pixels of a frame.
    width: u32,
    height: u32,
    adapter: String,
}

impl Experiment for Frames {
    type Row = Row;

    const NAME: &'static str = "frames";

    fn run(run: &mut Run) -> Vec<Row> {
        if run.view == View::Nothing {
            run.say("  no graphics adapter found: no frames can be drawn");
            return Vec::new();
        }
        let [width, height] = run.either([640, 360], [1280, 720]);
        let mut scene = Drawn::new(run.view, [width, height]);
        let adapter = scene.adapter().unwrap_or_default();
        // Once there and back for the ball.
        let rounds = run.either(3, 23);
        run.set("adapter", &adapter);
        run.set(
            "frames",
            format!("{width} × {height}, a tick of 1/64 s each, waited for until they are drawn"),
        );
        run.set("turns", format!("{rounds} rounds, in each {BLOCK} frames by each volume, one before them thrown away"));
        run.set(
            "scene",
            "the example ball's; volumes are refitted, all levels of the tree are drawn",
        );
        let every = BoundingVolume::ALL.map(|(_, volume)| (volume, true));
        let choices = every.into_iter().chain([(BoundingVolume::Sphere, false)]);
        let choices: Vec<_> = choices.collect();
        let mut rows = Vec::new();
        let mut frame = 0;
        run.begin(Self::NAME, rounds as usize);
        for round in 1..=rounds {
            for &(volume, drawn) in &choices {
                scene.show(volume, drawn.then_some(WHOLE));
                for place in 0..=BLOCK {
                    let time = seconds(|| scene.tick());
                    frame += 1;
                    if place > 0 {
                        rows.push(Row {
                            frame,
                            volume: volume.name().into(),
                            drawn,
                            fps: 1.0 / time,
                            round,
                            second: scene.seconds(),
                            width,
                            height,
                            adapter: adapter.clone(),
                        });
                    }
                }
            }
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        let kinds = kinds(rows);
        let count = |kind| of(rows, kind).count();
        let first = kinds.first().map_or(0, |&kind| count(kind));
        let is_even = kinds.iter().all(|&kind| count(kind) == first);
        let is_valid = rows.iter().all(|row| row.fps > 0.0 && row.fps.is_finite());
        if kinds.len() == 7 && is_even && is_valid {
            Ok(())
        } else {
            Err("as many frames by each of six volumes as with nothing drawn".into())
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let [(_, paper_spheres), (_, paper_boxes)] = PUBLISHED;
        let fps = |volume| spread(rows, (volume, true)).median;
        let plain = spread(rows, ("spheres", false)).median;
        let more = |volume| 1.0e3 / fps(volume) - 1.0e3 / plain;
        let every = kinds(rows).into_iter().filter(|(_, is_drawn)| *is_drawn);
        let slowest = every.min_by(|a, b| fps(a.0).total_cmp(&fps(b.0)));
        let slowest = slowest.map_or("", |(volume, _)| volume);
        let ratio = boxes_to_spheres(rows);
        let claim = if ratio.low > 1.0 {
            "Spheres are slower to draw than AABBs, as in the paper"
        } else if ratio.median > 1.0 {
            "Spheres are slower to draw than AABBs, as in the paper, but no more than the noise is"
        } else {
            "Spheres are not slower to draw than AABBs, other than in the paper"
        };
        vec![
            format!(
                "{claim}: on {}, {:.1} frames a second with spheres and {:.1} with AABBs, in the median round {:.2} × as many (quartiles {:.2} to {:.2}); the paper had {paper_spheres} and {paper_boxes}, {:.2} ×.",
                adapter(rows),
                fps("spheres"),
                fps("AABBs"),
                ratio.median,
                ratio.low,
                ratio.high,
                paper_boxes / paper_spheres,
            ),
            format!(
                "With nothing of the hierarchy drawn it is {plain:.1}: a frame takes {:.1} ms more with spheres, {:.1} with AABBs, {:.1} with {slowest}, the slowest.",
                more("spheres"),
                more("AABBs"),
                more(slowest),
            ),
        ]
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "volume",
            "frames a second, median",
            "quartiles",
            "ms a frame",
        ]);
        for (volume, is_drawn) in kinds(rows) {
            let fps = spread(rows, (volume, is_drawn));
            table.row([
                name(volume, is_drawn).into(),
                format!("{:.1}", fps.median),
                format!("{:.1} to {:.1}", fps.low, fps.high),
                format!("{:.1}", 1.0e3 / fps.median),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![figure_8(rows)]
    }
}

/// The paper's Figure 8, of which only the averages were published, and the same here.
fn figure_8(rows: &[Row]) -> Chart {
    let shown = [
        ("spheres", true),
        ("AABBs", true),
        ("26-DOPs", true),
        ("spheres", false),
    ];
    let look = |kind| match shown.iter().position(|&other| other == kind) {
        Some(style) if kind.1 => Look::Style(style),
        _ => Look::Grey,
    };
    let fps = || Axis::linear("frames a second");
    let highs = kinds(rows).into_iter().map(|kind| spread(rows, kind).high);
    let most = 1.3 * highs.fold(0.0, f64::max);
    let mut over = Panel::new(
        "Over the scene",
        Axis::linear("time (s)"),
        fps().between(0.0, most),
    );
    for kind in shown {
        let name = name(kind.0, kind.1);
        let points = rounds(rows).map(|round| {
            let frames = of(rows, kind).filter(move |row| row.round == round);
            let (seconds, fps): (Vec<f64>, Vec<f64>) =
                frames.map(|row| (row.second, row.fps)).unzip();
            [median(&seconds), median(&fps)]
        });
        over = over.with(Series::new(name, look(kind), Kind::Marked, points));
    }
    let mut kinds = kinds(rows);
    kinds.sort_by(|a, b| spread(rows, *b).median.total_cmp(&spread(rows, *a).median));
    let names = kinds.iter().map(|kind| name(kind.0, kind.1));
    let mut dots = Panel::new(
        "Each volume",
        fps().between(0.0, most.max(1.1 * PUBLISHED[1].1)),
        Axis::of_names("", names),
    );
    for (place, &kind) in kinds.iter().enumerate() {
        let fps = spread(rows, kind);
        let point = Point {
            at: [fps.median, place as f64],
            across: Some([fps.low, fps.high]),
            up: None,
        };
        dots = dots.with(Series::new("", look(kind), Kind::Points, [point]));
        let published = PUBLISHED.iter().find(|(volume, _)| (*volume, true) == kind);
        let published = published.map(|(_, fps)| [*fps, place as f64]);
        let name = "the paper's average";
        dots = dots.with(Series::new(name, Look::Style(3), Kind::Points, published));
    }
    let size = rows.first().map_or([0; 2], |row| [row.width, row.height]);
    Chart::new(
        "frames",
        format!(
            "AABBs are drawn {:.2} × as fast as spheres; in the paper {:.2} ×",
            boxes_to_spheres(rows).median,
            PUBLISHED[1].1 / PUBLISHED[0].1
        ),
        format!(
            "Frames of {} × {} pixels with all 341 volumes of a cloth of 16 × 16 drawn, by {}. Median and quartiles. The paper's machine was another.",
            size[0],
            size[1],
            adapter(rows)
        ),
    )
    .columns(2)
    .with(over)
    .with(dots)
}

fn adapter(rows: &[Row]) -> &str {
    rows.first().map_or("", |row| row.adapter.as_str())
}

fn rounds(rows: &[Row]) -> impl Iterator<Item = u32> {
    1..=rows.iter().map(|row| row.round).max().unwrap_or(0)
}

/// How many times as many frames a second AABBs have as spheres, round by round: what else the machine does comes and goes.
fn boxes_to_spheres(rows: &[Row]) -> Spread {
    let fps = |volume, round| {
        let frames = of(rows, (volume, true)).filter(|row| row.round == round);
        median(&frames.map(|row| row.fps).collect::<Vec<_>>())
    };
    let ratios = rounds(rows).map(|round| fps("AABBs", round) / fps("spheres", round));
    Spread::of(&ratios.collect::<Vec<_>>())
}

/// Each volume, and whether it is drawn, in the order in which they appear.
fn kinds(rows: &[Row]) -> Vec<(&str, bool)> {
    distinct(rows.iter().map(|row| (row.volume.as_str(), row.drawn)))
}

fn name(volume: &str, is_drawn: bool) -> &str {
    if is_drawn { volume } else { "not drawn" }
}

fn of<'a>(rows: &'a [Row], kind: (&'a str, bool)) -> impl Iterator<Item = &'a Row> {
    rows.iter()
        .filter(move |row| row.volume == kind.0 && row.drawn == kind.1)
}

fn spread(rows: &[Row], kind: (&str, bool)) -> Spread {
    let fps: Vec<f64> = of(rows, kind).map(|row| row.fps).collect();
    Spread::of(&fps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;

    #[test]
    fn frames_are_drawn_by_each_volume() {
        let view = View::without_window();
        if view == View::Nothing {
            let mut run = Run::new(true, view);
            assert!(Frames::run(&mut run).is_empty());
            return;
        }
        let rows = quick::<Frames>(view, "frame,volume,drawn,fps");
        assert!(rows.iter().all(|row| !row.adapter.is_empty()));
    }
}
