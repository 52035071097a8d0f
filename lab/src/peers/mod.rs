//! Real solvers, same scenes: what the package `peers` has measured, drawn.
//!
//! It is a package of its own, as no lab has to build and download other solvers: `peers/run` measures, and then calls this.

mod game_row;
mod games;
mod row;

pub use self::games::PeersGames;
use self::row::{BALL, CORNERS, EXPLICIT, OURS, ROW, Row, SOLVERS};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    experiment::{Experiment, Run, Table},
};

/// What titles and findings speak of.
const SETTING: &str = "20 sub-steps";

pub struct Peers;

impl Experiment for Peers {
    type Row = Row;

    const NAME: &'static str = "peers";

    fn run(run: &mut Run) -> Vec<Row> {
        run.say("  measured by the package `peers` (`peers/run`), drawn from its file by `-- peers --redraw`");
        Vec::new()
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for scene in [CORNERS, ROW, BALL] {
            if ours(rows, scene).is_none() {
                return Err(format!("{scene}: nothing of ours with {SETTING}"));
            }
        }
        for row in rows {
            let name = format!("{}, {}, {}", row.scene, row.solver, row.setting);
            if !SOLVERS.contains(&row.solver.as_str()) {
                return Err(format!("{name}: no solver that is known"));
            }
            let is_finite = [Some(row.max_stretch), row.position_error_m, row.depth_m]
                .into_iter()
                .flatten()
                .all(f64::is_finite);
            if row.solver == OURS && !is_finite {
                return Err(format!("{name}: it blew up"));
            }
        }
        Ok(())
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let mut findings = Vec::new();
        for (scene, what, value) in MEASURES {
            let Some(ours) = ours(rows, scene) else {
                continue;
            };
            let said = |row: &Row| {
                format!(
                    "{} ({}) {:.2} ms, {}",
                    row.solver,
                    row.setting,
                    row.ms_per_frame,
                    shown(value(row))
                )
            };
            let peer = match fastest_as_good(rows, scene, value) {
                Some(peer) => format!("the fastest peer that is as good: {}", said(peer)),
                None => "no peer is as good".into(),
            };
            findings.push(format!("{scene}, {what}: {}; {peer}.", said(ours)));
        }
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "scene",
            "solver",
            "setting",
            "ms a frame",
            "largest stretch, %",
            "RMS, %",
            "off, mm",
            "deep, mm",
        ]);
        for row in rows {
            table.row([
                row.scene.clone(),
                row.solver.clone(),
                row.setting.clone(),
                format!("{:.3}", row.ms_per_frame),
                shown(percent(row)),
                shown(Some(100.0 * row.rms_stretch)),
                shown(off(row)),
                shown(depth(row)),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![chart(rows)]
    }
}

type Measure = fn(&Row) -> Option<f64>;

/// What is drawn, panel by panel.
const MEASURES: [(&str, &str, Measure); 4] = [
    (CORNERS, "largest stretch (%)", percent),
    (CORNERS, "RMS position error (mm)", off),
    (ROW, "RMS position error (mm)", off),
    (BALL, "depth in the ball (mm)", depth),
];

fn percent(row: &Row) -> Option<f64> {
    Some(100.0 * row.max_stretch)
}

fn off(row: &Row) -> Option<f64> {
    row.position_error_m.map(|error| 1.0e3 * error)
}

fn depth(row: &Row) -> Option<f64> {
    row.depth_m.map(|depth| 1.0e3 * depth)
}

/// Three digits that count.
fn shown(value: Option<f64>) -> String {
    let Some(value) = value else {
        return "–".into();
    };
    if !value.is_finite() || value.abs() >= 1.0e4 {
        return "blows up".into();
    }
    let digits = (2 - value.abs().max(1.0e-6).log10().floor() as i32).clamp(0, 4);
    format!("{value:.*}", digits as usize)
}

fn of<'a>(rows: &'a [Row], scene: &'a str) -> impl Iterator<Item = &'a Row> {
    rows.iter().filter(move |row| row.scene == scene)
}

fn ours<'a>(rows: &'a [Row], scene: &'a str) -> Option<&'a Row> {
    of(rows, scene).find(|row| row.solver == OURS && row.setting == SETTING)
}

/// What is not worse by more than this part is as good: another start differs by as much.
const AS_GOOD: f64 = 0.1;

/// Threads that are this many times as long are no cloth any more.
const BLOWN_UP: f64 = 100.0;

fn is_blown_up(row: &Row) -> bool {
    is_blown_up_by(row.max_stretch)
}

fn is_blown_up_by(stretch: f64) -> bool {
    let is_cloth = stretch < BLOWN_UP;
    !is_cloth
}

/// The fastest of the others that is as good as ours with 20 sub-steps.
fn fastest_as_good<'a>(rows: &'a [Row], scene: &'a str, value: Measure) -> Option<&'a Row> {
    let best = value(ours(rows, scene)?)?;
    of(rows, scene)
        .filter(|row| row.solver != OURS && !is_blown_up(row))
        .filter(|row| value(row).is_some_and(|value| value <= (1.0 + AS_GOOD) * best))
        .min_by(|a, b| a.ms_per_frame.total_cmp(&b.ms_per_frame))
}

fn chart(rows: &[Row]) -> Chart {
    let ratio = |scene, value| {
        let ours = ours(rows, scene)?;
        let peer = fastest_as_good(rows, scene, value)?;
        Some(peer.ms_per_frame / ours.ms_per_frame)
    };
    let said = |ratio: Option<f64>| match ratio {
        Some(ratio) if ratio >= 10.0 => format!("{ratio:.0} ×"),
        Some(ratio) => format!("{ratio:.1} ×"),
        None => "none".into(),
    };
    let title = format!(
        "Real solvers, same scenes. Time of the fastest other one that is as good as ours in 20 sub-steps: stretch {}, rigid motion {}, soft motion {}, contact {}",
        said(ratio(CORNERS, percent)),
        said(ratio(CORNERS, off)),
        said(ratio(ROW, off)),
        said(ratio(BALL, depth)),
    );
    let mut chart = Chart::new(
        "peers",
        title,
        "64² particles, 2 m × 2 m, 60 frames a second, one thread, CPU time; medians of five starts. Position error: after 0.5 s, of solvers that take the same springs. Numbers: sub-steps or iterations. As good: worse by a tenth at most. What blows up, and a depth of 0, is not drawn.",
    )
    .sized([960, 900])
    .columns(2);
    for (scene, what, value) in MEASURES {
        let mut panel = Panel::new(
            scene,
            Axis::log("ms a frame, log"),
            Axis::log(format!("{what}, log")),
        );
        for (style, solver) in SOLVERS.into_iter().enumerate() {
            let rows: Vec<&Row> = of(rows, scene)
                .filter(|row| row.solver == solver && !is_blown_up(row))
                .collect();
            // What is said behind a comma is another way to use it, and on no line with the rest.
            let (plain, other): (Vec<&Row>, Vec<&Row>) =
                rows.iter().partition(|row| !row.setting.contains(','));
            for (kind, rows) in [(Kind::Marked, plain), (Kind::Points, other)] {
                let points = rows
                    .iter()
                    .filter_map(|row| Some([row.ms_per_frame, value(row).filter(|v| *v > 0.0)?]));
                panel = panel.with(Series::new(solver, Look::Style(style), kind, points));
            }
            let noted = rows.iter().filter(|row| row.solver != EXPLICIT);
            for (row, value) in noted.filter_map(|row| Some((row, value(row)?))) {
                if value.is_finite() && value > 0.0 {
                    panel = panel.note([row.ms_per_frame, value], note(&row.setting));
                }
            }
        }
        chart = chart.with(panel);
    }
    chart
}

/// The first number of a setting, and what is said behind a comma.
fn note(setting: &str) -> String {
    let (first, rest) = setting.split_once(',').unwrap_or((setting, ""));
    let number = first.split(' ').next().unwrap_or_default();
    format!("{number}{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, solver: &str, setting: &str, ms: f64, worth: f64) -> Row {
        Row {
            scene: scene.into(),
            solver: solver.into(),
            setting: setting.into(),
            ms_per_frame: ms,
            max_stretch: worth,
            rms_stretch: worth / 10.0,
            position_error_m: Some(worth),
            reference_error_m: None,
            depth_m: Some(worth),
        }
    }

    #[test]
    fn the_fastest_as_good_is_found() {
        let mut rows: Vec<Row> = [CORNERS, ROW, BALL]
            .into_iter()
            .flat_map(|scene| {
                [
                    row(scene, OURS, SETTING, 0.5, 0.02),
                    row(scene, "Jolt", "20 iterations", 2.0, 0.03),
                    row(scene, "Jolt", "80 iterations", 8.0, 0.02),
                    row(scene, "pypbd", "20 sub-steps", 6.0, f64::NAN),
                    row(scene, "MuJoCo flex", "1 step", 40.0, 0.01),
                ]
            })
            .collect();
        assert_eq!(Peers::check(&rows), Ok(()));
        let found = fastest_as_good(&rows, CORNERS, percent).expect("two are");
        assert_eq!(found.setting, "80 iterations");
        assert_eq!(Peers::charts(&rows)[0].panels.len(), MEASURES.len());
        rows[0].max_stretch = f64::NAN;
        assert!(Peers::check(&rows).is_err());
        rows.remove(0);
        assert!(Peers::check(&rows).is_err());
    }

    #[test]
    fn notes_are_short() {
        assert_eq!(note("20 iterations, tethers"), "20 tethers");
        assert_eq!(note("2 × 10 steps"), "2");
        assert_eq!(shown(Some(f64::NAN)), "blows up");
    }
}
