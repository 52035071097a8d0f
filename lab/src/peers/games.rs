//! Real solvers in scenes of games: what `peers/run --games` has measured, drawn.

use super::{
    game_row::{BALLOON, GAME_SOLVERS, GameRow, HUNG_MESH, SKIRT, TABLECLOTH},
    is_blown_up_by, shown,
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    experiment::{Experiment, Run, Table},
};

pub struct PeersGames;

/// The subject of titles.
const SETTING: &str = "default";

/// The largest stretch that solvers are compared at, scene by scene, as a part of the length.
const LIMITS: [(&str, f64); 4] = [
    (HUNG_MESH, 0.1),
    (SKIRT, 0.2),
    (TABLECLOTH, 0.2),
    (BALLOON, 0.2),
];

impl Experiment for PeersGames {
    type Row = GameRow;

    const NAME: &'static str = "peers_games";

    fn run(run: &mut Run) -> Vec<GameRow> {
        run.say("  measured by the package `peers` (`peers/run --games`), drawn from its file by `-- peers_games --redraw`");
        Vec::new()
    }

    fn check(rows: &[GameRow]) -> Result<(), String> {
        for (scene, _) in LIMITS {
            if ours(rows, scene).is_none() {
                return Err(format!(
                    "{scene}: nothing of ours with its {SETTING} settings"
                ));
            }
        }
        for row in rows {
            let name = format!("{}, {}, {}", row.scene, row.solver, row.setting);
            if !GAME_SOLVERS.contains(&row.solver.as_str()) {
                return Err(format!("{name}: no solver that is known"));
            }
            if row.solver == GAME_SOLVERS[0] && !(row.max_stretch + row.ms_per_frame).is_finite() {
                return Err(format!("{name}: it blew up"));
            }
        }
        Ok(())
    }

    fn findings(rows: &[GameRow]) -> Vec<String> {
        let mut findings = Vec::new();
        for (scene, limit) in LIMITS {
            let said = GAME_SOLVERS.map(|solver| match cheapest(rows, scene, solver, limit) {
                Some(row) => format!(
                    "{solver} {:.2} ms ({}, {} %)",
                    row.ms_per_frame,
                    row.setting,
                    shown(Some(100.0 * row.max_stretch))
                ),
                None => format!("{solver} has no setting tried"),
            });
            findings.push(format!(
                "{scene}, largest stretch of at most {} %: {}.",
                100.0 * limit,
                said.join("; ")
            ));
        }
        findings
    }

    fn table(rows: &[GameRow]) -> Table {
        let mut table = Table::new([
            "scene",
            "solver",
            "setting",
            "ms a frame",
            "longest",
            "largest stretch, %",
            "RMS, %",
            "deep, mm",
            "triangles, mm",
            "volume",
            "off",
        ]);
        for row in rows {
            let off = match (row.height_error_m, row.volume_error) {
                (Some(error), _) => format!("{} mm", shown(Some(1.0e3 * error))),
                (_, Some(error)) => format!("{} %", shown(Some(100.0 * error))),
                _ => "–".into(),
            };
            table.row([
                row.scene.clone(),
                row.solver.clone(),
                row.setting.clone(),
                format!("{:.2}", row.ms_per_frame),
                format!("{:.2}", row.ms_max),
                shown(Some(100.0 * row.max_stretch)),
                shown(Some(100.0 * row.rms_stretch)),
                shown(row.depth_m.map(|depth| 1.0e3 * depth)),
                shown(row.triangles_depth_m.map(|depth| 1.0e3 * depth)),
                shown(row.volume),
                off,
            ]);
        }
        table
    }

    fn charts(rows: &[GameRow]) -> Vec<Chart> {
        vec![chart(rows)]
    }
}

fn ours<'a>(rows: &'a [GameRow], scene: &str) -> Option<&'a GameRow> {
    of(rows, scene, GAME_SOLVERS[0]).find(|row| row.setting == SETTING)
}

fn of<'a>(rows: &'a [GameRow], scene: &str, solver: &str) -> impl Iterator<Item = &'a GameRow> {
    rows.iter()
        .filter(move |row| row.scene == scene && row.solver == solver)
}

/// The setting of a solver that takes the least time of those that stretch by no more than a limit.
fn cheapest<'a>(rows: &'a [GameRow], scene: &str, solver: &str, limit: f64) -> Option<&'a GameRow> {
    of(rows, scene, solver)
        .filter(|row| row.max_stretch <= limit)
        .min_by(|a, b| a.ms_per_frame.total_cmp(&b.ms_per_frame))
}

fn chart(rows: &[GameRow]) -> Chart {
    let said = LIMITS.map(|(scene, limit)| {
        let ms = |solver| cheapest(rows, scene, solver, limit).map(|row| row.ms_per_frame);
        let ours = ms(GAME_SOLVERS[0]);
        let others = GAME_SOLVERS[1..].iter().filter_map(|solver| ms(solver));
        let best = others.fold(f64::INFINITY, f64::min);
        let times = match ours {
            Some(ours) if best.is_finite() => format!("{:.1} ×", best / ours),
            _ => "none".into(),
        };
        format!("{scene} {times} ({} %)", 100.0 * limit)
    });
    let title = format!(
        "Scenes of games. Time of the fastest other solver over ours, where each stretches by no more than a limit: {}",
        said.join(", ")
    );
    let mut chart = Chart::new(
        "peers_games",
        title,
        "Meshes of cotton, 60 frames a second, one thread, CPU time. Stretch: of edges in the last third of four seconds. Numbers: sub-steps or iterations, or sub-steps × iterations. What blows up is not drawn.",
    )
    .sized([960, 900])
    .columns(2);
    for (scene, limit) in LIMITS {
        let mut panel = Panel::new(
            scene,
            Axis::log("ms a frame, log"),
            Axis::log("largest stretch (%), log"),
        );
        let drawn = |row: &&GameRow| !is_blown_up_by(row.max_stretch);
        for (style, solver) in GAME_SOLVERS.into_iter().enumerate() {
            let rows: Vec<&GameRow> = of(rows, scene, solver).filter(drawn).collect();
            // A setting with a comma is another way to use it, and on no line with the rest. So is one without a number.
            let (plain, other): (Vec<&GameRow>, Vec<&GameRow>) = rows
                .iter()
                .partition(|row| !row.setting.contains(',') && row.setting != SETTING);
            for (kind, rows) in [(Kind::Marked, plain), (Kind::Points, other)] {
                let points = rows
                    .iter()
                    .map(|row| [row.ms_per_frame, 100.0 * row.max_stretch]);
                panel = panel.with(Series::new(solver, Look::Style(style), kind, points));
            }
            for row in rows {
                let at = [row.ms_per_frame, 100.0 * row.max_stretch];
                panel = panel.note(at, note(&row.setting));
            }
        }
        let ms = rows.iter().filter(|row| row.scene == scene).filter(drawn);
        let [low, high] = ms.fold([f64::INFINITY, 0.0], |[low, high], row| {
            [row.ms_per_frame.min(low), row.ms_per_frame.max(high)]
        });
        let line = [low, high].map(|ms| [ms, 100.0 * limit]);
        panel = panel.with(Series::new("limit", Look::Grey, Kind::Line, line));
        chart = chart.with(panel);
    }
    chart
}

/// The numbers of a setting, and what is said behind a comma.
fn note(setting: &str) -> String {
    let (first, rest) = setting.split_once(',').unwrap_or((setting, ""));
    let is_unit = |word: &&str| *word != "iterations" && *word != "sub-steps";
    let words: Vec<&str> = first.split(' ').filter(is_unit).collect();
    format!("{}{rest}", words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, solver: &str, setting: &str, ms: f64, stretch: f64) -> GameRow {
        GameRow {
            scene: scene.into(),
            solver: solver.into(),
            setting: setting.into(),
            ms_per_frame: ms,
            ms_p99: ms,
            ms_max: ms,
            max_stretch: stretch,
            rms_stretch: stretch / 10.0,
            depth_m: None,
            triangles_depth_m: None,
            volume: None,
            height_error_m: Some(stretch),
            volume_error: None,
        }
    }

    #[test]
    fn the_cheapest_within_a_limit_is_found() {
        let mut rows: Vec<GameRow> = LIMITS
            .into_iter()
            .flat_map(|(scene, _)| {
                [
                    row(scene, GAME_SOLVERS[0], SETTING, 0.5, 0.01),
                    row(scene, GAME_SOLVERS[1], "20 iterations", 2.0, 0.03),
                    row(scene, GAME_SOLVERS[1], "80 iterations", 8.0, 0.02),
                    row(scene, GAME_SOLVERS[1], "5 iterations", 0.1, f64::NAN),
                    row(scene, GAME_SOLVERS[2], "4 × 8 iterations", 9.0, 0.5),
                ]
            })
            .collect();
        assert_eq!(PeersGames::check(&rows), Ok(()));
        let found =
            |limit| cheapest(&rows, SKIRT, GAME_SOLVERS[1], limit).map(|row| row.setting.as_str());
        assert_eq!(found(0.03), Some("20 iterations"));
        assert_eq!(found(0.02), Some("80 iterations"));
        assert_eq!(found(0.01), None);
        assert_eq!(PeersGames::charts(&rows)[0].panels.len(), LIMITS.len());
        rows[0].max_stretch = f64::NAN;
        assert!(PeersGames::check(&rows).is_err());
        rows.remove(0);
        assert!(PeersGames::check(&rows).is_err());
    }

    #[test]
    fn notes_are_short() {
        assert_eq!(note("20 iterations, tethers"), "20 tethers");
        assert_eq!(note("4 × 8 iterations"), "4 × 8");
        assert_eq!(note(SETTING), SETTING);
    }
}
