//! Cloth on cloth: what contact of cloth with itself and with others costs, and up to which speed and from which thickness on nothing
//! passes through.
//!
//! An app without a renderer, its systems one after the other. After every tick all pairs of triangles are compared by brute force.

mod charts;
mod play;

use serde::{Deserialize, Serialize};

use self::play::{Play, Scene};
use crate::{
    chart::Chart,
    experiment::{Experiment, Run, Table},
    measure::Spread,
};

pub struct Layers;

/// A scene at one speed, resolution and thickness.
#[derive(Debug, Serialize, Deserialize)]
pub struct Row {
    scene: String,
    /// Of a sheet.
    particles: u32,
    choice: String,
    /// Of what moves it, or as which it is thrown (m/s).
    speed: f32,
    /// Pairs of triangles that intersect, the most of any tick.
    intersections: usize,
    /// All of the plugin's systems, in the median.
    ms_per_tick: f64,
    /// The same without contact of cloth with cloth.
    ms_without: f64,
    /// How far layers are kept apart (m); 0 where they are not.
    thickness: f32,
    ticks: usize,
    /// In how many of the ticks any intersected.
    ticks_with: usize,
    /// Pairs of features that were near each other, the most of any tick.
    pairs: usize,
    /// Searches a tick.
    searches: f64,
    /// Whether all slept at the end.
    is_asleep: bool,
}

impl Row {
    /// What contact adds, over the tick without it.
    fn added(&self) -> f64 {
        self.ms_per_tick / self.ms_without - 1.0
    }

    fn is_cost(&self) -> bool {
        self.speed == 0.0
    }
}

/// Vertices with faces and edges with edges, found by the tree: what the plugin does.
const TRIANGLES: &str = "triangles, tree";
/// Nothing: what the scene asks for.
const NOTHING: &str = "nothing";

/// A run of a scene.
struct Case {
    scene: Scene,
    side: u32,
    speed: f32,
    thickness: Option<f32>,
}

impl Experiment for Layers {
    type Row = Row;

    const NAME: &'static str = "self";

    fn run(run: &mut Run) -> Vec<Row> {
        let cases = cases(run.quick);
        run.set("scene", "sheets of 1 m × 1 m of cotton, strips of 1.2 × 0.4 m, on a floor; 64 ticks a second, default settings");
        run.set("tick", "all of the plugin's systems, one after the other on one thread; with contact of cloth with cloth and without in turns");
        run.begin(Self::NAME, cases.len());
        let mut rows = Vec::new();
        for case in cases {
            rows.push(case.play());
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        let is_flat = |row: &&Row| row.scene == Scene::Flat.name();
        match rows.iter().filter(is_flat).find(|row| row.pairs > 0) {
            Some(row) => Err(format!("{} pairs in a flat sheet", row.pairs)),
            None => Ok(()),
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let mut findings = Vec::new();
        let with = || rows.iter().filter(|row| row.choice == TRIANGLES);
        for row in with().filter(|row| row.is_cost()) {
            findings.push(format!(
                "{}, {} particles: {:.3} ms a tick, {:.3} without ({:+.1} %), {:.1} searches a tick, {} pairs.",
                row.scene,
                row.particles,
                row.ms_per_tick,
                row.ms_without,
                100.0 * row.added(),
                row.searches,
                row.pairs
            ));
        }
        let moved = || with().filter(|row| !row.is_cost());
        let failed: Vec<_> = moved().filter(|row| row.intersections > 0).collect();
        findings.push(format!(
            "{} of {} runs without any intersection in any tick.",
            moved().count() - failed.len(),
            moved().count()
        ));
        for row in failed {
            findings.push(format!(
                "{}, {} particles, {} m/s, {:.0} mm thick: up to {} pairs of triangles intersect, in {} of {} ticks.",
                row.scene,
                row.particles,
                row.speed,
                1.0e3 * row.thickness,
                row.intersections,
                row.ticks_with,
                row.ticks
            ));
        }
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "scene",
            "particles",
            "choice",
            "m/s",
            "thickness (mm)",
            "intersections",
            "ticks with",
            "ms a tick",
            "without",
            "asleep",
        ]);
        for row in rows {
            table.row([
                row.scene.clone(),
                row.particles.to_string(),
                row.choice.clone(),
                row.speed.to_string(),
                format!("{:.1}", 1.0e3 * row.thickness),
                row.intersections.to_string(),
                format!("{}/{}", row.ticks_with, row.ticks),
                format!("{:.3}", row.ms_per_tick),
                format!("{:.3}", row.ms_without),
                row.is_asleep.to_string(),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![charts::all(rows)]
    }
}

fn cases(quick: bool) -> Vec<Case> {
    let mut cases = Vec::new();
    let costs: &[(Scene, u32)] = if quick {
        &[(Scene::Flat, 32), (Scene::Folded, 16)]
    } else {
        &[
            (Scene::Flat, 64),
            (Scene::Flat, 128),
            (Scene::Folded, 32),
            (Scene::Folded, 64),
            (Scene::Fifty, 32),
        ]
    };
    for &(scene, side) in costs {
        cases.push(Case {
            scene,
            side,
            speed: 0.0,
            thickness: Some(0.003),
        });
    }
    let speeds: &[f32] = if quick { &[2.0] } else { &[1.0, 5.0, 20.0] };
    let scenes: &[Scene] = if quick {
        &[Scene::Drop, Scene::Twist]
    } else {
        &[
            Scene::Fold,
            Scene::Twist,
            Scene::Drop,
            Scene::Stack,
            Scene::Balls,
            Scene::Pole,
        ]
    };
    let drops = if quick { 1 } else { 20 };
    let side = if quick { 16 } else { 24 };
    let mut add = |scene, side, speed, thickness| {
        cases.push(Case {
            scene,
            side,
            speed,
            thickness,
        });
    };
    for &speed in speeds {
        for &scene in scenes {
            // Faster, the pole would turn by more than half a turn in a tick.
            if scene == Scene::Pole && speed > 10.0 {
                continue;
            }
            let side = if scene == Scene::Stack { 12 } else { side };
            add(scene, side, speed, Some(0.008));
        }
        for drop in 0..drops {
            add(Scene::Random(drop), 16, speed, Some(0.008));
        }
    }
    if !quick {
        for &speed in speeds {
            for thickness in [0.002, 0.004, 0.016] {
                add(Scene::Drop, side, speed, Some(thickness));
            }
            add(Scene::Drop, 40, speed, Some(0.008));
        }
    }
    // What happens without.
    add(Scene::Drop, side, speeds[0], None);
    cases
}

impl Case {
    fn play(&self) -> Row {
        let Self {
            scene,
            side,
            speed,
            thickness,
        } = *self;
        let ticks = scene.ticks(speed.max(0.1));
        let mut with = Play::new(scene, side, speed, thickness);
        let mut without = Play::new(scene, side, speed, None);
        let (mut worst, mut ticks_with, mut most, mut searches) = (0, 0, 0, 0.0);
        for _ in 0..ticks {
            with.tick();
            without.tick();
            // Brute force is slow, and no surprise where nothing moves.
            let count = if speed > 0.0 { with.intersections() } else { 0 };
            worst = worst.max(count);
            ticks_with += usize::from(count > 0);
            let (pairs, searched) = with.pairs();
            most = most.max(pairs);
            searches += f64::from(searched) / ticks as f64;
        }
        Row {
            scene: scene.name().into(),
            particles: side * side,
            choice: if thickness.is_some() {
                TRIANGLES
            } else {
                NOTHING
            }
            .into(),
            speed,
            intersections: worst,
            ms_per_tick: Spread::of(with.ms()).median,
            ms_without: Spread::of(without.ms()).median,
            thickness: thickness.unwrap_or(0.0),
            ticks,
            ticks_with,
            pairs: most,
            searches,
            is_asleep: with.is_asleep(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{experiment::quick, view::View};

    #[test]
    fn cloth_on_cloth_is_measured_and_intersects_without() {
        let rows = quick::<Layers>(
            View::Nothing,
            "scene,particles,choice,speed,intersections,ms_per_tick,ms_without",
        );
        let of = |choice: &str| {
            let rows = rows.iter().filter(move |row| row.choice == choice);
            rows.filter(|row| !row.is_cost())
                .map(|row| row.intersections)
                .collect::<Vec<_>>()
        };
        assert!(of(TRIANGLES).iter().all(|&count| count == 0));
        assert!(
            of(NOTHING).iter().all(|&count| count > 0),
            "it is asked for"
        );
    }
}
