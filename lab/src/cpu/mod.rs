//! The paper's test of CPU utilisation: what part of a core the process takes while the scene goes on at its own pace, with
//! the hierarchy drawn and not drawn, by every volume.

mod charts;

use std::{
    cmp::Ordering,
    thread,
    time::{Duration, Instant},
};

use bevy_drape::hierarchy::BoundingVolume;
use examples_shared::view::View;
use serde::{Deserialize, Serialize};
use sysinfo::{ProcessRefreshKind, ProcessesToUpdate, System};

use crate::{
    chart::Chart,
    drawn::{Drawn, SMALL, WHOLE},
    experiment::{Experiment, Run, Table},
    measure::{Spread, distinct, median},
};

/// Frames a second that are kept where the machine can.
const PACE: f64 = 60.0;

/// A turn with nothing drawn goes on until this much of the CPU is used, of which hundredths can be told, or so long has
/// passed (s).
const ENOUGH: f64 = 0.2;
const LONGEST: f64 = 1.0;

/// Of what the system counts CPU time in (s).
const STEP: f64 = 0.01;

pub struct Cpu;

/// One turn of one volume.
#[derive(Serialize, Deserialize)]
pub struct Row {
    /// How far the scene has come.
    second: f64,
    volume: String,
    /// 100 for one core.
    cpu_percent: f64,
    drawn: bool,
    /// That the turn really had.
    fps: f64,
    cpu_ms_per_frame: f64,
    /// All volumes take their turn in a round.
    round: u32,
    threads: usize,
    /// What drew, if anything did.
    adapter: Option<String>,
    /// CPU time of the turn: both figures come from it, and it is counted in hundredths.
    cpu_seconds: f64,
}

/// What this process has taken of the CPU.
struct Meter(System);

impl Meter {
    /// So far (s), as finely as the system counts: hundredths on Linux.
    fn seconds(&mut self) -> Option<f64> {
        let id = sysinfo::get_current_pid().ok()?;
        self.0.refresh_processes_specifics(
            ProcessesToUpdate::Some(&[id]),
            false,
            ProcessRefreshKind::nothing().with_cpu(),
        );
        Some(self.0.process(id)?.accumulated_cpu_time() as f64 / 1.0e3)
    }
}

impl Experiment for Cpu {
    type Row = Row;

    const NAME: &'static str = "cpu";

    fn run(run: &mut Run) -> Vec<Row> {
        let Ok(mut meter) = System::new().map(Meter) else {
            run.say("  this system does not tell what a process takes of the CPU");
            return Vec::new();
        };
        let mut scene = Drawn::new(run.view, SMALL);
        let adapter = scene.adapter();
        match &adapter {
            Some(adapter) => run.set("adapter", adapter),
            None => run.say("  no graphics adapter found: measured with nothing drawn"),
        }
        let (turn, rounds) = run.either((0.25, 2), (1.0, 12));
        run.set("turns", format!("{rounds} rounds, in each {turn} s by each volume, at {PACE} frames a second where that can be kept; with nothing drawn on to {ENOUGH} s of CPU time or to {LONGEST} s"));
        run.set(
            "cpu_percent",
            "100 is one core; user and system time of the whole process",
        );
        run.set(
            "scene",
            format!(
                "the example ball's, in an image of {} × {}: next to nothing is for filling it",
                SMALL[0], SMALL[1]
            ),
        );
        let mut choices = Vec::new();
        for (place, (_, volume)) in BoundingVolume::ALL.into_iter().enumerate() {
            if run.view != View::Nothing {
                choices.push((volume, true));
            }
            // A short run with a renderer: spheres and AABBs alone.
            if !run.quick || run.view == View::Nothing || place < 2 {
                choices.push((volume, false));
            }
        }
        let threads = thread::available_parallelism().map_or(1, usize::from);
        scene.follow_the_clock();
        let mut rows = Vec::new();
        run.begin(Self::NAME, rounds as usize);
        for round in 1..=rounds {
            for &(volume, drawn) in &choices {
                // A short run goes round a second time for what is set against each other.
                let is_compared = matches!(volume, BoundingVolume::Sphere | BoundingVolume::Aabb);
                if run.quick && round > 1 && !is_compared {
                    continue;
                }
                scene.show(volume, drawn.then_some(WHOLE));
                (0..2).for_each(|_| scene.tick());
                let Some(before) = meter.seconds() else {
                    return rows;
                };
                let start = Instant::now();
                let mut frames = 0;
                let (wall, taken) = loop {
                    frames += at_pace(&mut scene, turn);
                    let wall = start.elapsed().as_secs_f64();
                    let Some(after) = meter.seconds() else {
                        return rows;
                    };
                    let taken = after - before;
                    if drawn || taken >= ENOUGH || wall >= LONGEST {
                        break (wall, taken);
                    }
                };
                rows.push(Row {
                    second: scene.seconds(),
                    volume: volume.name().into(),
                    cpu_percent: 100.0 * taken / wall,
                    drawn,
                    fps: f64::from(frames) / wall,
                    cpu_ms_per_frame: 1.0e3 * taken / f64::from(frames),
                    round,
                    threads,
                    adapter: adapter.clone(),
                    cpu_seconds: taken,
                });
            }
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for row in rows {
            let is_valid = row.cpu_percent >= 0.0 && row.cpu_percent.is_finite();
            if !is_valid || row.fps > 1.2 * PACE {
                return Err(format!(
                    "{}: {:.0} % at {:.0} frames a second",
                    row.volume, row.cpu_percent, row.fps
                ));
            }
        }
        let volumes = |is_drawn: bool| {
            let kinds = kinds(rows).into_iter().filter(|kind| kind.1 == is_drawn);
            kinds.count()
        };
        if volumes(true).max(volumes(false)) == BoundingVolume::ALL.len() {
            Ok(())
        } else {
            Err("each of six volumes".into())
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let mut findings = Vec::new();
        for is_drawn in [true, false] {
            let of = |volume, figure: Figure| spread(rows, (volume, is_drawn), figure).median;
            let [used, time] =
                [utilisation, frame_time].map(|figure| spheres_to_boxes(rows, is_drawn, figure));
            if !rows.iter().any(|row| row.drawn == is_drawn) {
                continue;
            }
            let how = if is_drawn { "drawn" } else { "nothing drawn" };
            if !time.median.is_finite() {
                findings.push(format!(
                    "With {how}, AABBs took less of the CPU than the system counts: spheres can't be set against them."
                ));
                continue;
            }
            let doubt = doubt(rows, is_drawn);
            let frame = match against_one(time, doubt) {
                Ordering::Greater => "a frame takes more CPU time with spheres than with AABBs",
                Ordering::Equal => {
                    "a frame's CPU time with spheres differs from that with AABBs no more than the noise does"
                }
                Ordering::Less => "a frame takes less CPU time with spheres than with AABBs",
            };
            // The paper's is about drawing.
            let claim = match (is_drawn, against_one(used, doubt)) {
                (false, _) => format!("With nothing drawn, {frame}"),
                (true, Ordering::Greater) => format!(
                    "The CPU is utilised more with spheres drawn than with AABBs, as in the paper, and {frame}"
                ),
                (true, Ordering::Equal) => format!(
                    "Utilisation does not tell drawn spheres from AABBs within the noise, other than in the paper; {frame}"
                ),
                (true, Ordering::Less) => format!(
                    "The CPU is utilised less with spheres drawn than with AABBs, other than in the paper; {frame}"
                ),
            };
            findings.push(format!(
                "{claim}: {:.0} % of a core at {:.0} frames a second against {:.0} % at {:.0}, in the median round {:.2} ×{}; {:.1} ms a frame against {:.1}, {:.2} × (quartiles {:.2} to {:.2}).",
                of("spheres", utilisation),
                of("spheres", |row| row.fps),
                of("AABBs", utilisation),
                of("AABBs", |row| row.fps),
                used.median,
                if is_drawn { ", where the paper has about 1.15" } else { "" },
                of("spheres", frame_time),
                of("AABBs", frame_time),
                time.median,
                time.low,
                time.high,
            ));
        }
        if let Some(adapter) = adapter(rows) {
            findings.push(format!(
                "What drew was {adapter}{}.",
                if adapter.contains("software") {
                    ": the lines are drawn by the CPU itself, which a graphics card would spare it"
                } else {
                    ""
                }
            ));
        }
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "volume",
            "drawn",
            "% of a core, median",
            "quartiles",
            "CPU ms a frame",
            "frames a second",
        ]);
        for kind in kinds(rows) {
            let percent = spread(rows, kind, utilisation);
            table.row([
                kind.0.into(),
                if kind.1 { "drawn" } else { "not drawn" }.into(),
                format!("{:.0}", percent.median),
                format!("{:.0} to {:.0}", percent.low, percent.high),
                format!("{:.2}", spread(rows, kind, frame_time).median),
                format!("{:.0}", spread(rows, kind, |row| row.fps).median),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![charts::figure_10(rows)]
    }
}

/// Draws frames for so long (s), none before its time. Returns how many.
fn at_pace(scene: &mut Drawn, seconds: f64) -> u32 {
    let start = Instant::now();
    let mut frames = 0;
    while start.elapsed().as_secs_f64() < seconds {
        scene.tick();
        frames += 1;
        let next = f64::from(frames) / PACE;
        let early = next - start.elapsed().as_secs_f64();
        if early > 0.0 {
            thread::sleep(Duration::from_secs_f64(early));
        }
    }
    frames
}

fn adapter(rows: &[Row]) -> Option<&str> {
    rows.first().and_then(|row| row.adapter.as_deref())
}

/// A figure of a turn.
type Figure = fn(&Row) -> f64;

fn utilisation(row: &Row) -> f64 {
    row.cpu_percent
}

fn frame_time(row: &Row) -> f64 {
    row.cpu_ms_per_frame
}

/// How many times as much as with AABBs it is with spheres, round by round.
fn spheres_to_boxes(rows: &[Row], is_drawn: bool, figure: Figure) -> Spread {
    let last = rows.iter().map(|row| row.round).max().unwrap_or(0);
    let of = |volume: &str, round| {
        let mut turns = rows
            .iter()
            .filter(|row| row.volume == volume && row.drawn == is_drawn && row.round == round);
        turns.next().map(figure)
    };
    let ratios = (1..=last).filter_map(|round| {
        let (spheres, boxes) = of("spheres", round).zip(of("AABBs", round))?;
        (boxes > 0.0).then(|| spheres / boxes)
    });
    Spread::of(&ratios.collect::<Vec<_>>())
}

/// By which part spheres against AABBs may be wrong since CPU time is counted in steps: one step in each turn, less over
/// several rounds.
fn doubt(rows: &[Row], is_drawn: bool) -> f64 {
    let turns = |volume: &str| {
        let turns = rows
            .iter()
            .filter(|row| row.volume == volume && row.drawn == is_drawn);
        turns.map(|row| row.cpu_seconds).collect::<Vec<_>>()
    };
    let (spheres, boxes) = (turns("spheres"), turns("AABBs"));
    let rounds = spheres.len().min(boxes.len()) as f64;
    STEP * (1.0 / median(&spheres) + 1.0 / median(&boxes)) / rounds.sqrt()
}

/// Whether it is more than one, less, or either within the noise.
fn against_one(ratio: Spread, doubt: f64) -> Ordering {
    if ratio.low > 1.0 + doubt {
        Ordering::Greater
    } else if ratio.high < 1.0 - doubt {
        Ordering::Less
    } else {
        Ordering::Equal
    }
}

/// Each volume, and whether it is drawn, in the order in which they appear.
fn kinds(rows: &[Row]) -> Vec<(&str, bool)> {
    distinct(rows.iter().map(|row| (row.volume.as_str(), row.drawn)))
}

fn spread(rows: &[Row], kind: (&str, bool), figure: Figure) -> Spread {
    let turns = rows
        .iter()
        .filter(|row| (row.volume.as_str(), row.drawn) == kind);
    Spread::of(&turns.map(figure).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;

    #[test]
    fn something_is_found_and_drawn_even_of_no_cpu_time() {
        let turn = |volume: &str, cpu_ms_per_frame| Row {
            second: 1.0,
            volume: volume.into(),
            cpu_percent: 0.06 * 100.0 * cpu_ms_per_frame,
            drawn: false,
            fps: PACE,
            cpu_ms_per_frame,
            round: 1,
            threads: 1,
            adapter: None,
            cpu_seconds: 0.06 * cpu_ms_per_frame,
        };
        let none: Vec<Row> = BoundingVolume::ALL.map(|(name, _)| turn(name, 0.0)).into();
        assert_eq!(Cpu::check(&none), Ok(()));
        assert_eq!(Cpu::findings(&none).len(), 1);
        let chart = charts::figure_10(&none);
        assert!(chart.title.contains("less of the CPU"));
        let folder =
            std::env::temp_dir().join(format!("bevy_drape_lab_no_cpu_{}", std::process::id()));
        chart.save(&folder).expect("an axis from 0 to more");
        std::fs::remove_dir_all(folder).expect("it was made");
        let less = [turn("spheres", 1.0), turn("AABBs", 2.0)];
        assert!(Cpu::findings(&less)[0].contains("takes less CPU time with spheres"));
        // Less than a step of the count apart.
        let alike = [turn("spheres", 0.6), turn("AABBs", 0.5)];
        assert!(Cpu::findings(&alike)[0].contains("no more than the noise"));
    }

    #[test]
    fn cpu_is_measured_for_each_volume() {
        let view = View::without_window();
        let rows = quick::<Cpu>(view, "second,volume,cpu_percent");
        let is_drawn = view == View::Offscreen;
        assert_eq!(rows.iter().any(|row| row.drawn), is_drawn);
        assert!(rows.iter().all(|row| row.adapter.is_some() == is_drawn));
    }
}
