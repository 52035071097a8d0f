//! A strip that is clamped level at one end, against the heavy elastica.
//!
//! How far it droops depends on Γ = w L³ ⁄ D alone: its weight per area, free length and rigidity. It must not depend on how many
//! particles it has, how wide it is and into how many sub-steps a tick is cut. Drawn beside it: what springs between every second
//! particle do.

mod strip;

use serde::{Deserialize, Serialize};

use self::strip::{drop_of, drop_of_chords};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    experiment::{Experiment, Run, Table},
    measure::distinct,
};

/// Γ, and the drop of the free end over its length (the elastica w s cos φ = D φ″, by shooting in f64).
const TRUTH: [[f64; 2]; 7] = [
    [1.0, 0.1235],
    [2.0, 0.2385],
    [5.0, 0.4959],
    [10.0, 0.7002],
    [20.0, 0.8299],
    [50.0, 0.9079],
    [100.0, 0.9375],
];

/// Particles across, and of how many of those along wider ones are.
const ROWS: u32 = 2;
const WIDER: [u32; 4] = [3, 5, 9, 17];

const OURS: &str = "ours";
const CHORDS: &str = "rigid chords";

/// How far the finest may be from the truth, and any from that of other sub-steps, as parts of the length. In exact arithmetic
/// 17 particles along it are off by 0.0025, 33 by 0.0005.
const WITHIN: f64 = 0.01;
const ALIKE: f64 = 0.01;

pub struct Bending;

/// One strip at rest.
#[derive(Serialize, Deserialize)]
pub struct Row {
    gamma: f64,
    particles: usize,
    substeps: u32,
    /// Over the strip's length, as the truth is.
    drop: f64,
    truth: f64,
    /// Ours, or chords, which know of no Γ.
    method: String,
    /// Particles across.
    rows: u32,
}

impl Row {
    /// Particles along it.
    fn along(&self) -> usize {
        self.particles / self.rows as usize
    }

    /// Whether it is one of those that are compared by resolution.
    fn is_narrow(&self) -> bool {
        self.rows == ROWS
    }
}

impl Experiment for Bending {
    type Row = Row;

    const NAME: &'static str = "bending";

    fn run(run: &mut Run) -> Vec<Row> {
        run.set("scene", format!("a strip of 0.3 m, 0.15 kg/m2, {ROWS} or more rows, its threads rigid, clamped level by two columns; still after 8 s at 60 ticks a second, damping 0.05"));
        run.set("gamma", "weight per area x length^3 / rigidity");
        run.set("drop", "of the free end, over the length");
        run.set(
            CHORDS,
            "rigid springs between every second particle of a row: the same for every gamma",
        );
        let columns = run.either(vec![17], vec![9, 17, 33, 65]);
        let substeps = run.either(vec![10, 20], vec![5, 10, 20, 40]);
        let wider = run.either(&WIDER[1..2], &WIDER);
        let finest = columns[columns.len() - 1];
        let all_narrow = columns.iter().map(|&columns| [columns, ROWS]);
        let sizes: Vec<[u32; 2]> = all_narrow
            .chain(wider.iter().map(|&rows| [finest, rows]))
            .collect();
        run.begin(Self::NAME, sizes.len() * substeps.len());
        let mut rows = Vec::new();
        for &size in &sizes {
            for &substeps in &substeps {
                let chords = (size[1] == ROWS).then(|| drop_of_chords(size, substeps));
                for [gamma, truth] in TRUTH {
                    let ours = (OURS, drop_of(gamma, size, substeps));
                    let chords = chords.map(|drop| (CHORDS, drop));
                    for (method, drop) in std::iter::once(ours).chain(chords) {
                        rows.push(Row {
                            gamma,
                            particles: (size[0] * size[1]) as usize,
                            substeps,
                            drop,
                            truth,
                            method: method.into(),
                            rows: size[1],
                        });
                    }
                }
                run.step();
            }
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        if let Some(row) = rows.iter().find(|row| !row.drop.is_finite()) {
            return Err(format!("{}, gamma {}: NaN", row.method, row.gamma));
        }
        let finest = rows.iter().map(Row::along).max();
        let mut wrong = Vec::new();
        for row in rows.iter().filter(|row| row.method == OURS) {
            let name = format!(
                "gamma {}, {} particles, {} sub-steps",
                row.gamma, row.particles, row.substeps
            );
            if Some(row.along()) == finest && (row.drop - row.truth).abs() > WITHIN {
                wrong.push(format!("{name}: {:.4} of {:.4}", row.drop, row.truth));
            }
            let others = rows.iter().filter(|other| {
                other.method == OURS && other.gamma == row.gamma && other.particles == row.particles
            });
            let apart = others.map(|other| (other.drop - row.drop).abs());
            if apart.fold(0.0, f64::max) > ALIKE {
                wrong.push(format!("{name}: {:.4} and otherwise in others", row.drop));
            }
        }
        if wrong.is_empty() {
            Ok(())
        } else {
            Err(wrong.join("\n"))
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let finest = rows.iter().map(Row::along).max();
        let ours = rows.iter().filter(|row| row.method == OURS);
        let of_finest = ours.filter(|row| Some(row.along()) == finest);
        let widest = rows.iter().map(|row| row.rows).max().unwrap_or(ROWS);
        let off = of_finest.map(|row| (row.drop - row.truth).abs());
        let [low, high] = chords(rows);
        vec![
            format!(
                "The finest strip, {ROWS} to {widest} rows wide, is at most {:.2} % of its length beside the elastica, over two decades of weight against rigidity.",
                100.0 * off.fold(0.0, f64::max)
            ),
            format!(
                "The same strip with rigid chords droops by {:.0} to {:.0} % of its length, by resolution and sub-steps alone.",
                100.0 * low,
                100.0 * high
            ),
        ]
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "method",
            "gamma",
            "particles",
            "sub-steps",
            "drop / length",
            "elastica",
        ]);
        for row in rows {
            table.row([
                row.method.clone(),
                format!("{:.0}", row.gamma),
                row.particles.to_string(),
                row.substeps.to_string(),
                format!("{:.4}", row.drop),
                format!("{:.4}", row.truth),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![chart(rows)]
    }
}

/// The least and the most that chords droop.
fn chords(rows: &[Row]) -> [f64; 2] {
    let drops = || {
        let chords = rows.iter().filter(|row| row.method == CHORDS);
        chords.map(|row| row.drop)
    };
    [
        drops().fold(f64::INFINITY, f64::min),
        drops().fold(0.0, f64::max),
    ]
}

/// Ours by resolution on the left and by width in the middle, chords on the right.
fn chart(rows: &[Row]) -> Chart {
    let [low, high] = chords(rows);
    let chart = Chart::new(
        "bending",
        format!(
            "A clamped strip droops as the elastica; with chords in place of bending, by {:.0} to {:.0} % of its length whatever it is made of",
            100.0 * low,
            100.0 * high
        ),
        "0.3 m, clamped level. Markers of one kind: one resolution, or all widths, in every number of sub-steps.",
    )
    .sized([1200, 520])
    .columns(3);
    let by_resolution = |method: &str| {
        let of_method = || {
            rows.iter()
                .filter(|row| row.is_narrow() && row.method == method)
        };
        let numbers = distinct(of_method().map(Row::along));
        let each = numbers.iter().map(|&along| {
            let of = of_method().filter(|row| row.along() == along);
            (format!("{along} along it"), points(of))
        });
        each.collect::<Vec<_>>()
    };
    let resolutions = by_resolution(OURS).len();
    let finest = rows.iter().map(Row::along).max();
    let of_finest = rows
        .iter()
        .filter(|row| row.method == OURS && Some(row.along()) == finest);
    let widths = distinct(of_finest.clone().map(|row| row.rows));
    let widths: Vec<String> = widths.iter().map(ToString::to_string).collect();
    let by_width = (
        format!("{} across it", widths.join(", ")),
        points(of_finest),
    );
    chart
        .with(panel("Ours", 0, by_resolution(OURS)))
        .with(panel("Ours, of any width", resolutions, vec![by_width]))
        .with(panel("Rigid chords", 0, by_resolution(CHORDS)))
}

fn points<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<[f64; 2]> {
    rows.map(|row| [row.gamma, row.drop]).collect()
}

/// The elastica, and markers by name, of one style after the other.
fn panel(title: &str, first_style: usize, markers: Vec<(String, Vec<[f64; 2]>)>) -> Panel {
    let panel = Panel::new(
        title,
        Axis::log("weight against rigidity, Γ, log"),
        Axis::linear("drop over length").between(0.0, 1.2),
    )
    .with(Series::new("elastica", Look::Ink, Kind::Line, TRUTH));
    let each = markers.into_iter().enumerate();
    each.fold(panel, |panel, (style, (name, points))| {
        let look = Look::Style(first_style + style);
        panel.with(Series::new(name, look, Kind::Points, points))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn strips_droop_as_the_elastica() {
        let rows = quick::<Bending>(View::Nothing, "gamma,particles,substeps,drop,truth");
        // Two ways of one width, and one of another.
        assert_eq!(rows.len(), 3 * TRUTH.len() * 2);
    }
}
