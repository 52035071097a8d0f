//! Closed forms of sheets, strips and membranes, for a grid and for meshes of all kinds, at default settings.
//!
//! A mesh has to be as true as a grid. Where it is not, this is how far it is off.

mod play;
mod truths;

use serde::{Deserialize, Serialize};

use self::truths::Truth;
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    experiment::{Experiment, Run, Table},
    measure::distinct,
    surfaces::Made,
};

/// The error that is allowed of a grid.
const GRID_WITHIN: f64 = 0.02;
/// The error that is allowed of a mesh of squares, unless it is woven and has alternating diagonals.
const EVEN_WITHIN: f64 = 0.04;
/// The error of clamped strips that is allowed, as a part of their length, on any surface.
const DROP_WITHIN: f64 = 0.01;

pub struct Fabrics;

/// One truth, and the value of a surface.
#[derive(Serialize, Deserialize)]
pub struct Row {
    truth: String,
    surface: String,
    particles: usize,
    /// In a tick of 1/64 s; 0 for the default.
    substeps: u32,
    value: f64,
    expected: f64,
}

impl Row {
    /// Its error, as a fraction of the truth; of a strip that droops, of its length.
    fn off(&self) -> f64 {
        let difference = self.value - self.expected;
        if self.is_drop() {
            difference
        } else {
            difference / self.expected
        }
    }

    fn is_drop(&self) -> bool {
        self.truth.starts_with(Truth::DROOP)
    }

    fn is_of(&self, made: Made) -> bool {
        self.surface == made.name()
    }
}

impl Experiment for Fabrics {
    type Row = Row;

    const NAME: &'static str = "fabrics";

    fn run(run: &mut Run) -> Vec<Row> {
        run.set("scene", "sheets and strips at default settings, 64 ticks a second; substeps 0 are automatic ones");
        let sides = run.either(vec![17], vec![17, 33, 65]);
        run.begin(Self::NAME, Made::ALL.len() * Truth::ALL.len());
        let mut rows = Vec::new();
        for made in Made::ALL {
            for truth in Truth::ALL {
                run.step();
                // A short run measures these of one surface alone.
                let is_short = run.either(truth.is_slow() && made != Made::Regular, false);
                if !truth.is_of(made) || is_short {
                    continue;
                }
                // Only these are measured at more than one resolution.
                let is_refined = matches!(truth, Truth::Membrane | Truth::Taut);
                let sides = if is_refined { &sides[..] } else { &sides[..1] };
                for &side in sides {
                    let found = truth.find(made, side);
                    rows.push(Row {
                        truth: truth.name(),
                        surface: made.name().into(),
                        particles: found.particles,
                        substeps: 0,
                        value: found.value,
                        expected: found.expected,
                    });
                }
            }
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        let mut wrong = Vec::new();
        for row in rows {
            let is_even = row.is_of(Made::Regular)
                || row.is_of(Made::Alternating) && !row.truth.starts_with(Truth::WOVEN);
            let within = if row.is_drop() {
                DROP_WITHIN
            } else if row.is_of(Made::Grid) {
                GRID_WITHIN
            } else if is_even {
                EVEN_WITHIN
            } else {
                f64::INFINITY
            };
            if row.off().abs() > within || row.off().is_nan() {
                wrong.push(format!(
                    "{} of {} particles, {}: {:.4} of {:.4}",
                    row.truth, row.particles, row.surface, row.value, row.expected
                ));
            }
        }
        if wrong.is_empty() {
            Ok(())
        } else {
            Err(wrong.join("\n"))
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        Made::ALL
            .into_iter()
            .map(|made| {
                let own = rows.iter().filter(|row| row.is_of(made));
                let worst = own.max_by(|a, b| a.off().abs().total_cmp(&b.off().abs()));
                let worst = worst.map_or((0.0, ""), |row| (row.off(), &row.truth));
                format!(
                    "{}: off by {:+.1} % at most, in “{}”.",
                    made.name(),
                    100.0 * worst.0,
                    worst.1
                )
            })
            .collect()
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "truth",
            "surface",
            "particles",
            "value",
            "expected",
            "off, %",
        ]);
        for row in rows {
            table.row([
                row.truth.clone(),
                row.surface.clone(),
                row.particles.to_string(),
                format!("{:.4}", row.value),
                format!("{:.4}", row.expected),
                format!("{:.1}", 100.0 * row.off()),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![chart(rows)]
    }
}

/// The error of each surface, truth by truth, at the resolution at which it is off most.
fn chart(rows: &[Row]) -> Chart {
    let truths = distinct(rows.iter().map(|row| row.truth.clone()));
    let panel = Panel::new(
        "",
        Axis::linear("error, %; -100 is a mode that does not swing").between(-110.0, 60.0),
        Axis::of_names("", truths.iter().rev().cloned()),
    );
    let panel = Made::ALL
        .into_iter()
        .enumerate()
        .fold(panel, |panel, (style, made)| {
            let points = truths.iter().rev().enumerate().filter_map(|(at, truth)| {
                let own = rows
                    .iter()
                    .filter(|row| row.is_of(made) && row.truth == *truth);
                let worst = own.max_by(|a, b| a.off().abs().total_cmp(&b.off().abs()))?;
                let beside = 0.12 * (2.0 - style as f64);
                Some([100.0 * worst.off(), at as f64 + beside])
            });
            let points: Vec<[f64; 2]> = points.collect();
            panel.with(Series::new(
                made.name(),
                Look::Style(style),
                Kind::Points,
                points,
            ))
        });
    Chart::new(
        "fabrics",
        "How far grids and meshes are off what is true, at default settings",
        "Clamped strips: of their length. Membrane and taut strip: at the worst of all resolutions.",
    )
    .sized([1100, 620])
    .with(panel)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn what_is_even_is_true() {
        let rows = quick::<Fabrics>(
            View::Nothing,
            "truth,surface,particles,substeps,value,expected",
        );
        // A grid has no strip at 45°, and none that stiffens.
        assert_eq!(
            rows.len(),
            Made::ALL.len() * Truth::ALL.len() - 2 - 2 * (Made::ALL.len() - 1)
        );
    }
}
