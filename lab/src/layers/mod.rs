//! Cloth on cloth: what contact of cloth with itself and with others costs, and up to which speed and from which thickness on nothing
//! passes through.
//!
//! An app without a renderer, its systems one after the other. After every tick all pairs of triangles are compared by brute force.
//! Drops are compared with other choices: with [balls](particles) found by a hash, and with a [hash] in place of the tree.

mod charts;
mod compared;
mod hash;
mod particles;
mod play;

use serde::{Deserialize, Serialize};

use self::{
    hash::FeatureHash,
    particles::Plain,
    play::{Play, Scene},
};
use crate::{
    chart::Chart,
    experiment::{Experiment, Run, Table},
    measure::{Spread, seconds},
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
    /// All of the plugin's systems, in the median; of balls, a plain loop over solver and contact; of a hash of triangles, the tick
    /// without contact and one search.
    ms_per_tick: f64,
    /// The same without contact of cloth with cloth.
    ms_without: f64,
    /// How far layers, or balls, are kept apart (m); 0 where they are not.
    thickness: f32,
    /// That were watched: none where pairs are only searched for.
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
/// Particles as balls, found by a uniform hash: what most engines do.
const PARTICLES: &str = "particles, hash";
/// The plugin's pairs found by a uniform hash once a tick, in the states that the plugin comes to. There is no response, so its time is a
/// lower bound.
const HASH: &str = "triangles, hash";
/// Nothing: what the scene asks for.
const NOTHING: &str = "nothing";

/// What keeps layers apart, and how far (m).
#[derive(Debug, Clone, Copy, PartialEq)]
enum Choice {
    Nothing,
    Triangles(f32),
    Particles(f32),
}

/// Up to this speed nothing may pass through anything (m/s).
const HELD: f32 = 20.0;

/// A run of a scene.
struct Case {
    scene: Scene,
    side: u32,
    speed: f32,
    choice: Choice,
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
            match case.choice {
                Choice::Particles(thickness) => rows.push(case.play_particles(thickness)),
                _ => rows.extend(case.play()),
            }
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        let is_flat = |row: &&Row| row.scene == Scene::Flat.name();
        if let Some(row) = rows.iter().filter(is_flat).find(|row| row.pairs > 0) {
            return Err(format!("{} pairs in a flat sheet", row.pairs));
        }
        let is_held = |row: &&Row| row.choice == TRIANGLES && row.speed <= HELD;
        match rows
            .iter()
            .filter(is_held)
            .find(|row| row.intersections > 0)
        {
            Some(row) => Err(format!(
                "{} pairs of triangles intersect: {}, {} m/s",
                row.intersections, row.scene, row.speed
            )),
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
        findings.extend(compared::findings(rows));
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
            choice: Choice::Triangles(0.003),
        });
    }
    let speeds: &[f32] = if quick {
        &[2.0]
    } else {
        &[1.0, 5.0, 20.0, 60.0]
    };
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
    let mut add = |scene, side, speed, choice| {
        cases.push(Case {
            scene,
            side,
            speed,
            choice,
        });
    };
    let thick = Choice::Triangles(THICKNESS);
    for &speed in speeds {
        for &scene in scenes {
            // Faster, the pole would turn by more than half a turn in a tick.
            if scene == Scene::Pole && speed > 10.0 {
                continue;
            }
            let side = if scene == Scene::Stack { 12 } else { side };
            add(scene, side, speed, thick);
        }
        for drop in 0..drops {
            add(Scene::Random(drop), 16, speed, thick);
        }
    }
    if !quick {
        for &speed in speeds {
            for thickness in [0.002, 0.004, 0.016] {
                add(Scene::Drop, side, speed, Choice::Triangles(thickness));
            }
            add(Scene::Drop, 40, speed, thick);
        }
    }
    // What happens without.
    add(Scene::Drop, side, speeds[0], Choice::Nothing);
    // What others do, as thick and as the spacing.
    for &speed in speeds {
        add(Scene::Drop, side, speed, Choice::Particles(THICKNESS));
        if quick {
            continue;
        }
        add(Scene::Drop, side, speed, Choice::Particles(spacing(side)));
        for drop in 0..drops {
            for thickness in [THICKNESS, spacing(16)] {
                add(Scene::Random(drop), 16, speed, Choice::Particles(thickness));
            }
        }
    }
    cases
}

/// How far layers are kept apart where nothing else is said (m).
const THICKNESS: f32 = 0.008;

/// Between the particles of a sheet of 1 m that has so many along each side (m).
fn spacing(side: u32) -> f32 {
    1.0 / (side - 1) as f32
}

impl Case {
    fn play(&self) -> Vec<Row> {
        let (thickness, choice) = match self.choice {
            Choice::Triangles(thickness) => (Some(thickness), TRIANGLES),
            _ => (None, NOTHING),
        };
        let Self {
            scene, side, speed, ..
        } = *self;
        let mut with = Play::new(scene, side, speed, thickness);
        let mut without = Play::new(scene, side, speed, None);
        // One sheet alone.
        let is_hashed = matches!(scene, Scene::Drop | Scene::Random(_) | Scene::Folded);
        let mut hash =
            (thickness.is_some() && is_hashed).then(|| FeatureHash::new(&with.cloth().0));
        let (mut searches_ms, mut hashed) = (Vec::new(), 0);
        let mut row = self.row(choice, thickness);
        for _ in 0..row.ticks {
            with.tick();
            without.tick();
            // Brute force is slow, and no surprise where nothing moves.
            let count = if speed > 0.0 { with.intersections() } else { 0 };
            row.watch(count, with.pairs());
            if let (Some(hash), Some(thickness)) = (&mut hash, thickness) {
                let (_, particles, _) = with.cloth();
                let mut pairs = 0;
                let passed = seconds(|| pairs = hash.search(particles.positions(), thickness));
                searches_ms.push(1.0e3 * passed);
                hashed = hashed.max(pairs);
            }
        }
        row.ms_per_tick = Spread::of(with.ms()).median;
        row.ms_without = Spread::of(without.ms()).median;
        row.is_asleep = with.is_asleep();
        let searched = hash.map(|_| Row {
            ms_per_tick: row.ms_without + Spread::of(&searches_ms).median,
            ms_without: row.ms_without,
            ticks: 0,
            pairs: hashed,
            searches: 1.0,
            ..self.row(HASH, thickness)
        });
        std::iter::once(row).chain(searched).collect()
    }

    fn play_particles(&self, thickness: f32) -> Row {
        let mut start = Play::new(self.scene, self.side, self.speed, None);
        let mut with = Plain::new(&mut start, Some(thickness));
        let mut without = Plain::new(&mut start, None);
        let mut row = self.row(PARTICLES, Some(thickness));
        for _ in 0..row.ticks {
            with.tick();
            without.tick();
            row.watch(with.intersections(), with.pairs());
        }
        row.ms_per_tick = Spread::of(&with.ms).median;
        row.ms_without = Spread::of(&without.ms).median;
        row
    }

    /// Nothing has been measured yet.
    fn row(&self, choice: &str, thickness: Option<f32>) -> Row {
        Row {
            scene: self.scene.name().into(),
            particles: self.side * self.side,
            choice: choice.into(),
            speed: self.speed,
            intersections: 0,
            ms_per_tick: f64::NAN,
            ms_without: f64::NAN,
            thickness: thickness.unwrap_or(0.0),
            ticks: self.scene.ticks(self.speed.max(0.1)),
            ticks_with: 0,
            pairs: 0,
            searches: 0.0,
            is_asleep: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

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
        let balls = rows.iter().find(|row| row.choice == PARTICLES);
        assert!(balls.is_some_and(|row| row.pairs > 0 && row.searches >= 1.0));
        // Each row of the hash stands behind that of the tree, whose states it searches. Its boxes are no nearer than what is in them.
        let mut hashed = rows.windows(2).filter(|rows| rows[1].choice == HASH);
        assert!(hashed.all(|rows| rows[1].pairs > 0 && rows[1].ticks == 0));
    }
}
