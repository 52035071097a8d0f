//! How it is hung: stretch and time of a cloth of rigid threads for six ways of pinning it.
//!
//! 64² particles, 2 m × 2 m, 0.15 kg/m², threads and diagonals rigid, no bending, no damping: it lies flat at rest and is let go,
//! for three seconds of 60 ticks each. By its settings by default, but for the sub-steps. A grid, and a mesh of triangles that lie
//! in all directions.

mod play;

use bevy_drape::solver::{ClothSettings, Substepping};
use serde::{Deserialize, Serialize};

use self::play::{PINS, SIDE, TICKS, WIDTH, larger, play};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series, number},
    experiment::{Experiment, Run, Table},
    measure::{distinct, median},
    surfaces::Made,
};

const TOLERANCE: &str = "tolerance 0.01";

/// The structures of the cloth.
const MADE: [Made; 2] = [Made::Grid, Made::Delaunay];

/// The series of a panel: name, structure, style and value.
const SERIES: [(&str, Made, usize, fn(&Row) -> f64); 4] = [
    ("grid, largest", Made::Grid, 0, |row| row.max_stretch),
    ("grid, RMS", Made::Grid, 5, |row| row.rms_stretch),
    ("mesh, largest", Made::Delaunay, 1, |row| row.max_stretch),
    ("mesh, RMS", Made::Delaunay, 4, |row| row.rms_stretch),
];

/// Energy that nothing gave, at most, as a part of what the cloth's weight can do.
const MAX_GAIN: f64 = 0.01;

pub struct Hung;

/// One structure, one way of pinning, and one choice of sub-steps.
#[derive(Serialize, Deserialize)]
pub struct Row {
    surface: String,
    pins: String,
    particles: usize,
    /// Sub-steps a tick, or the largest stretch that is asked for.
    choice: String,
    ms_per_tick: f64,
    /// Of structural springs in the last second, as parts of their length.
    max_stretch: f64,
    rms_stretch: f64,
    /// The largest kinetic and potential energy of any tick less the start's, over the start's above the lowest that could be
    /// reached: each particle's weight × its distance from the nearest pin in the flat cloth, all summed up.
    energy_gain: f64,
}

/// Name of each choice, and what it is.
fn choices(quick: bool) -> Vec<(String, Substepping)> {
    let fixed: &[u32] = if quick {
        &[10, 20]
    } else {
        &[10, 20, 30, 40, 60]
    };
    let fixed = fixed
        .iter()
        .map(|&count| (count.to_string(), Substepping::Fixed(count)));
    let held = ClothSettings::tolerance(0.01).substepping;
    fixed.chain([(TOLERANCE.into(), held)]).collect()
}

impl Experiment for Hung {
    type Row = Row;

    const NAME: &'static str = "hung";

    fn run(run: &mut Run) -> Vec<Row> {
        let starts = run.either(1, 5);
        run.set(
            "scene",
            format!("{SIDE}², {WIDTH} m wide, rigid threads and diagonals, 0.15 kg/m², no bending, no damping, from lying flat at rest, {TICKS} ticks of 1/60 s"),
        );
        run.set(
            "stretch",
            "over structural springs and all ticks of the last second",
        );
        run.set(
            "energy_gain",
            "(largest kinetic + potential energy of any tick - the start's) / (sum of weight x distance from the nearest pin)",
        );
        run.set(
            "starts",
            format!("medians over {starts}, in each another particle 1 µm aside; of energy_gain the largest"),
        );
        let choices = choices(run.quick);
        run.begin(Self::NAME, MADE.len() * PINS.len() * choices.len());
        let mut rows = Vec::new();
        let hung = MADE.iter().flat_map(|made| PINS.map(|pins| (*made, pins)));
        for (made, (pins, pinned)) in hung {
            for (choice, substepping) in &choices {
                let outcomes: Vec<_> = (0..starts)
                    .map(|start| play(made, pinned, *substepping, start))
                    .collect();
                let of = |value: fn(&play::Outcome) -> f64| {
                    median(&outcomes.iter().map(value).collect::<Vec<_>>())
                };
                rows.push(Row {
                    surface: made.name().into(),
                    pins: pins.into(),
                    particles: outcomes[0].particles,
                    choice: choice.clone(),
                    ms_per_tick: of(|outcome| outcome.ms_per_tick),
                    max_stretch: of(|outcome| outcome.max_stretch),
                    rms_stretch: of(|outcome| outcome.rms_stretch),
                    energy_gain: outcomes
                        .iter()
                        .map(|outcome| outcome.energy_gain)
                        .fold(0.0, larger),
                });
                run.step();
            }
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        let ways = distinct(rows.iter().map(|row| row.pins.as_str()));
        let choices = distinct(rows.iter().map(|row| row.choice.as_str()));
        if ways.len() != PINS.len() || rows.len() != MADE.len() * ways.len() * choices.len() {
            return Err("each choice for each surface and way of pinning".into());
        }
        for row in rows {
            let name = format!("{}, {}, {}", row.surface, row.pins, row.choice);
            let is_valid = row.ms_per_tick > 0.0
                && row.rms_stretch > 0.0
                && row.rms_stretch <= row.max_stretch.abs().max(1.0)
                && row.max_stretch.is_finite();
            if !is_valid {
                return Err(format!("{name}: stretched by {}", row.max_stretch));
            }
            // NaN is not.
            let is_kept = row.energy_gain <= MAX_GAIN;
            if !is_kept {
                return Err(format!(
                    "{name}: gains {} of what its weight can do",
                    row.energy_gain
                ));
            }
        }
        let hung = MADE
            .iter()
            .flat_map(|made| ways.iter().map(|pins| (*made, pins)));
        for (made, pins) in hung {
            let fixed: Vec<&Row> = fixed(rows, made, pins).collect();
            if let [few, .., many] = fixed[..]
                && many.rms_stretch > few.rms_stretch
            {
                return Err(format!(
                    "{}, {pins}: {} sub-steps leave an RMS stretch of {}, {} of {}",
                    made.name(),
                    many.choice,
                    many.rms_stretch,
                    few.choice,
                    few.rms_stretch
                ));
            }
        }
        Ok(())
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let said = |row: &Row| {
            format!(
                "{} {} % (RMS {} %, {:.2} ms)",
                row.pins,
                percent(row.max_stretch),
                percent(row.rms_stretch),
                row.ms_per_tick
            )
        };
        let mut findings = Vec::new();
        for name in MADE.map(Made::name) {
            let of = |choice: &'static str| {
                let rows = rows.iter().filter(|row| row.surface == name);
                rows.filter(move |row| row.choice == choice)
            };
            let list = |choice| of(choice).map(said).collect::<Vec<_>>().join(", ");
            let exceeded: Vec<&str> = of(TOLERANCE)
                .filter(|row| row.max_stretch > 0.01)
                .map(|row| row.pins.as_str())
                .collect();
            let exceeded = if exceeded.is_empty() {
                "is held everywhere".into()
            } else {
                format!("is exceeded: {}", exceeded.join(", "))
            };
            findings.push(format!(
                "Largest stretch at 20 sub-steps, {name}: {}.",
                list("20")
            ));
            findings.push(format!(
                "A tolerance of 1 %, {name}, {exceeded}. With it: {}.",
                list(TOLERANCE)
            ));
        }
        findings.push(format!(
            "Energy is gained by at most {:.2} % of what the cloth's weight can do.",
            100.0 * rows.iter().map(|row| row.energy_gain).fold(0.0, f64::max)
        ));
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "surface",
            "pins",
            "choice",
            "ms a tick",
            "largest stretch, %",
            "RMS, %",
            "energy gained, %",
        ]);
        for row in rows {
            table.row([
                row.surface.clone(),
                row.pins.clone(),
                row.choice.clone(),
                format!("{:.3}", row.ms_per_tick),
                percent(row.max_stretch),
                percent(row.rms_stretch),
                format!("{:.2}", 100.0 * row.energy_gain),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![chart(rows)]
    }
}

/// With three digits that count.
fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    let digits = (2 - percent.abs().max(1.0e-6).log10().floor() as i32).clamp(0, 4);
    format!("{percent:.*}", digits as usize)
}

/// Those with a fixed number of sub-steps, the fewest first.
fn fixed<'a>(rows: &'a [Row], made: Made, pins: &'a str) -> impl Iterator<Item = &'a Row> {
    of(rows, made, pins).filter(|row| row.choice != TOLERANCE)
}

/// Those of one structure that are pinned in one way.
fn of<'a>(rows: &'a [Row], made: Made, pins: &'a str) -> impl Iterator<Item = &'a Row> {
    rows.iter()
        .filter(move |row| row.surface == made.name() && row.pins == pins)
}

/// A panel a way of pinning.
fn chart(rows: &[Row]) -> Chart {
    let worst = |made: Made| {
        let at_20 = rows
            .iter()
            .filter(move |row| row.surface == made.name() && row.choice == "20");
        let worst = 100.0 * at_20.map(|row| row.max_stretch).fold(0.0, larger);
        let digits = usize::from(worst < 10.0);
        format!("{worst:.digits$}")
    };
    let title = format!(
        "20 sub-steps: a rigid grid stretches by up to {} %, an irregular mesh by up to {} %",
        worst(Made::Grid),
        worst(Made::Delaunay)
    );
    let mut chart = Chart::new(
        "hung",
        title,
        format!(
            "{SIDE}² particles, {WIDTH} m × {WIDTH} m, rigid, undamped, let go from lying flat: stretch of its threads in the last of three seconds. Numbers: sub-steps. Points apart: a tolerance of {} %.",
            number(1.0)
        ),
    )
    .sized([960, 800])
    .columns(3);
    // The same for all, so that panels can be compared.
    let times = || rows.iter().map(|row| row.ms_per_tick);
    let ends = [
        times().fold(f64::INFINITY, f64::min) / 1.3,
        times().fold(0.0, f64::max) * 1.8,
    ];
    let stretches = || {
        rows.iter()
            .flat_map(|row| [row.max_stretch, row.rms_stretch])
    };
    let range = [
        100.0 * stretches().fold(f64::INFINITY, f64::min) / 1.5,
        100.0 * stretches().fold(0.0, f64::max) * 1.5,
    ];
    for (pins, _) in PINS {
        let mut panel = Panel::new(
            pins,
            Axis::log("ms a tick, log").between(ends[0], ends[1]),
            Axis::log("stretch (%), log").between(range[0], range[1]),
        );
        for (name, made, style, value) in SERIES {
            let point = |row: &Row| [row.ms_per_tick, 100.0 * value(row)];
            let look = Look::Style(style);
            // By time: a line that turns back is drawn with a spike.
            let mut line: Vec<[f64; 2]> = fixed(rows, made, pins).map(point).collect();
            line.sort_by(|a, b| a[0].total_cmp(&b[0]));
            panel = panel.with(Series::new(name, look, Kind::Marked, line));
            let held = of(rows, made, pins).filter(|row| row.choice == TOLERANCE);
            panel = panel.with(Series::new("", look, Kind::Points, held.map(point)));
        }
        for row in fixed(rows, Made::Delaunay, pins) {
            let at = [row.ms_per_tick, 100.0 * row.max_stretch];
            panel = panel.note(at, row.choice.clone());
        }
        chart = chart.with(panel);
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn each_way_of_pinning_is_played() {
        let rows = quick::<Hung>(
            View::Nothing,
            "surface,pins,particles,choice,ms_per_tick,max_stretch,rms_stretch,energy_gain",
        );
        assert_eq!(rows.len(), MADE.len() * PINS.len() * choices(true).len());
        assert!(rows.iter().all(|row| row.particles == 4096));
    }

    #[test]
    fn pins_are_where_they_are_said_to_be() {
        let counts = PINS.map(|(_, pinned)| {
            let all = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column)));
            all.filter(|&(row, column)| pinned(row, column)).count()
        });
        assert_eq!(counts, [2, 1, 1, 5, 64, 64]);
    }
}
