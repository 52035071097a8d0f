//! What flags cost that are far from the camera, with and without level of detail.
//!
//! An app without a renderer, its systems one after the other: all of the plugin's systems in a tick. Some flags are near the camera, the
//! others in a row away from it. The same without level of detail, and with the near flags alone, in the same turns.

mod stage;

use serde::{Deserialize, Serialize};

use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Point, Series},
    experiment::{Experiment, Run, Table},
    measure::Spread,
};
use stage::{Flags, Stage};

pub struct Lod;

/// Some flags, some of them near.
#[derive(Debug, Serialize, Deserialize)]
pub struct Row {
    cloths: u32,
    near: u32,
    lod: String,
    /// All of the plugin's systems, in the median.
    ms_per_tick: f64,
    /// Quartiles of it.
    ms_low: f64,
    ms_high: f64,
    /// Flags that were moved in a tick, in the mean.
    moved: f64,
    /// Whether the near flags, and no others, were at the full rate where they should be.
    is_as_said: bool,
}

const FLAGS: u32 = 60;

/// For the findings and the title.
const EXAMPLE: u32 = 10;

impl Experiment for Lod {
    type Row = Row;

    const NAME: &'static str = "lod";

    fn run(run: &mut Run) -> Vec<Row> {
        let turns = run.either(16, 400);
        let near = run.either(&[0, 10, 60][..], &[0, 2, 5, 10, 20, 30, 40, 50, 60]);
        run.set("scene", "60 flags of 24 × 16 particles that swing; near ones 10 m from the camera, the others in a row from 30 m on, 3 m apart");
        run.set("lod", "ClothLod::default(): every 2nd tick from 25 m on, every 4th from 50 m, frozen from 100 m");
        run.set("turns", turns);
        run.set(
            "tick",
            "all of the plugin's systems, one after the other on one thread, in turns",
        );
        run.begin(Self::NAME, near.len());
        let mut rows = Vec::new();
        for &near in near {
            let mut stages = Flags::ALL.map(|flags| Stage::new(FLAGS, near, flags));
            stages.iter_mut().for_each(|stage| stage.warm_up(32));
            for _ in 0..turns {
                stages.iter_mut().for_each(Stage::turn);
            }
            for (mut stage, flags) in stages.into_iter().zip(Flags::ALL) {
                let spread = Spread::of(stage.ms());
                rows.push(Row {
                    cloths: if flags == Flags::NearAlone {
                        near
                    } else {
                        FLAGS
                    },
                    near,
                    lod: flags.name().into(),
                    ms_per_tick: spread.median,
                    ms_low: spread.low,
                    ms_high: spread.high,
                    moved: stage.moved(),
                    is_as_said: stage.is_as_said(),
                });
            }
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for row in rows {
            // Of those that are far and not frozen, from 30 m to 100 m, a half or a quarter in a tick.
            let far = (FLAGS - row.near).min(24);
            let most = match row.lod == Flags::ByDistance.name() {
                true => f64::from(row.near) + 0.5 * f64::from(far),
                false => f64::from(row.cloths),
            };
            if !row.is_as_said || row.moved > most + 0.5 {
                return Err(format!(
                    "{} of {} flags near, level of detail {}: {} are moved in a tick, or others than the near ones are at the full rate",
                    row.near, row.cloths, row.lod, row.moved
                ));
            }
        }
        Ok(())
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let near = crate::measure::distinct(rows.iter().map(|row| row.near));
        let finding = |near: u32| {
            let [full, lod, alone] = Flags::ALL.map(|flags| ms(rows, near, flags));
            format!(
                "{FLAGS} flags, {near} near: {:.3} ms a tick without level of detail, {:.3} with, {:.3} for the near ones alone.",
                full?, lod?, alone?
            )
            .into()
        };
        near.into_iter().filter_map(finding).collect()
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new(["level of detail", "flags", "near", "ms a tick", "moved"]);
        for row in rows {
            table.row([
                row.lod.clone(),
                row.cloths.to_string(),
                row.near.to_string(),
                format!("{:.4}", row.ms_per_tick),
                format!("{:.1}", row.moved),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        let mut panel = Panel::new(
            "",
            Axis::linear("flags of 60 that are near the camera"),
            Axis::linear("ms a tick"),
        );
        let names = [
            "60 flags, all at the full rate",
            "60 flags by `ClothLod::default()`",
            "the near flags alone",
        ];
        for (style, (flags, name)) in Flags::ALL.into_iter().zip(names).enumerate() {
            let points = of(rows, flags).map(|row| Point {
                at: [f64::from(row.near), row.ms_per_tick],
                across: None,
                up: Some([row.ms_low, row.ms_high]),
            });
            panel = panel.with(Series::new(name, Look::Style(style), Kind::Marked, points));
        }
        let [full, lod] = [Flags::Full, Flags::ByDistance].map(|flags| ms(rows, EXAMPLE, flags));
        let title = match (full, lod) {
            (Some(full), Some(lod)) => format!(
                "{FLAGS} flags, {EXAMPLE} of them near: {lod:.2} ms a tick with level of detail, {full:.2} without"
            ),
            _ => "What flags cost that are far".into(),
        };
        let subtitle = "All of the plugin's systems in a tick, on one thread; flags of 24 × 16 particles that swing, the far ones in a row from 30 m on, 3 m apart. Every 2nd tick from 25 m on, every 4th from 50 m, frozen from 100 m. Medians and quartiles, in the same turns.";
        vec![Chart::new("lod", title, subtitle).with(panel)]
    }
}

fn of(rows: &[Row], flags: Flags) -> impl Iterator<Item = &Row> {
    rows.iter().filter(move |row| row.lod == flags.name())
}

fn ms(rows: &[Row], near: u32, flags: Flags) -> Option<f64> {
    let row = of(rows, flags).find(|row| row.near == near);
    row.map(|row| row.ms_per_tick)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn far_flags_are_moved_less_often() {
        let rows = quick::<Lod>(View::Nothing, "cloths,near,lod,ms_per_tick");
        assert_eq!(rows.len(), 9);
        let moved = |near, flags| {
            of(&rows, flags)
                .find(|row| row.near == near)
                .map(|row| row.moved)
        };
        assert_eq!(moved(60, Flags::ByDistance), Some(60.0));
        assert_eq!(moved(10, Flags::Full), Some(60.0));
        assert!(moved(10, Flags::ByDistance).is_some_and(|moved| moved < 22.5));
    }
}
