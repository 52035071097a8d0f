//! Layers in scenes of games: what contact of cloth with cloth adds to a tick, in the mean and at worst.
//!
//! An app without a renderer, 60 ticks a second, its systems one after the other on one thread, at default settings. After each
//! tick with layers, all pairs of triangles are compared by brute force in f64.

mod cast;
mod garments;
mod scenes;

use bevy::{asset::AssetPlugin, prelude::*};
use bevy_drape::prelude::*;
use serde::{Deserialize, Serialize};

use self::{
    cast::{Layers, Moved, RATE, follow},
    scenes::{SCENES, Scene},
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    experiment::{Experiment, Run, Table},
    timed::{self, Clock, TimedTicks},
};

pub struct Games;

/// A scene, with contact of cloth with cloth (`layers` 1) or without (0).
#[derive(Debug, Serialize, Deserialize)]
pub struct Row {
    scene: String,
    particles: usize,
    layers: u8,
    /// All of the plugin's systems in a tick: mean, 99th percentile, largest.
    ms_per_tick: f64,
    ms_p99: f64,
    ms_max: f64,
    /// The mean without layers.
    ms_without: f64,
    searches_per_tick: f64,
    /// Listed pairs of features, the most of any tick.
    pairs: usize,
    /// Pairs of triangles that intersect, the most of any tick.
    intersections: usize,
}

impl Experiment for Games {
    type Row = Row;

    const NAME: &'static str = "games";

    fn run(run: &mut Run) -> Vec<Row> {
        run.set(
            "scene",
            "cotton at default settings, 60 ticks a second; layers 5 mm thick",
        );
        run.set(
            "tick",
            "all of the plugin's systems, one after the other on one thread",
        );
        run.begin(Self::NAME, SCENES.len());
        let mut rows = Vec::new();
        for scene in &SCENES {
            let ticks = run.either(scene.ticks / 12, scene.ticks);
            let without = Play::new(scene, false).row(ticks, 0.0);
            let with = Play::new(scene, true).row(ticks, without.ms_per_tick);
            rows.push(Row {
                ms_without: without.ms_per_tick,
                ..without
            });
            rows.push(with);
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        let scene = |name: &str| SCENES.iter().find(|scene| scene.name == name);
        let crossed = rows.iter().find(|row| {
            let begins_apart = scene(&row.scene).is_none_or(|scene| scene.begins_apart);
            row.layers == 1 && begins_apart && row.intersections > 0
        });
        match crossed {
            Some(row) => Err(format!(
                "{} pairs of triangles intersect: {}",
                row.intersections, row.scene
            )),
            None => Ok(()),
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let with = rows.iter().filter(|row| row.layers == 1);
        with.map(|row| {
            format!(
                "{}: layers add {:.2} ms to a tick of {:.2} ms; the longest tick takes {:.1} ms.",
                row.scene,
                row.ms_per_tick - row.ms_without,
                row.ms_without,
                row.ms_max
            )
        })
        .collect()
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "scene",
            "particles",
            "layers",
            "ms a tick",
            "p99",
            "max",
            "searches",
            "pairs",
            "crossed",
        ]);
        for row in rows {
            table.row([
                row.scene.clone(),
                row.particles.to_string(),
                row.layers.to_string(),
                format!("{:.2}", row.ms_per_tick),
                format!("{:.2}", row.ms_p99),
                format!("{:.2}", row.ms_max),
                format!("{:.1}", row.searches_per_tick),
                row.pairs.to_string(),
                row.intersections.to_string(),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        let with: Vec<&Row> = rows.iter().filter(|row| row.layers == 1).collect();
        let count = with.len() as f64;
        let mut panel = Panel::new(
            "",
            Axis::log("ms a tick, log").between(0.02, 3000.0),
            Axis::linear("").between(0.0, count + 1.0).named(
                with.iter()
                    .enumerate()
                    .map(|(index, row)| (count - index as f64, row.scene.as_str())),
            ),
        );
        let each = || {
            with.iter()
                .enumerate()
                .map(|(index, row)| (count - index as f64, *row))
        };
        let points = |of: fn(&Row) -> f64| each().map(|(y, row)| [of(row), y]).collect::<Vec<_>>();
        for (y, row) in each() {
            let line = vec![[row.ms_without, y], [row.ms_max, y]];
            panel = panel.with(Series::new("", Look::Grey, Kind::Line, line));
        }
        let panel = panel
            .with(Series::new(
                "without layers, mean",
                Look::Style(0),
                Kind::Points,
                points(|row| row.ms_without),
            ))
            .with(Series::new(
                "with layers, mean",
                Look::Style(1),
                Kind::Points,
                points(|row| row.ms_per_tick),
            ))
            .with(Series::new(
                "with layers, 99th percentile",
                Look::Style(2),
                Kind::Points,
                points(|row| row.ms_p99),
            ))
            .with(Series::new(
                "with layers, longest",
                Look::Style(3),
                Kind::Points,
                points(|row| row.ms_max),
            ));
        let chart = Chart::new(
            "games",
            "What layers cost in scenes of games",
            "All of the plugin's systems in a tick, on one thread, at default settings: without contact of cloth with cloth, and with it in the mean, in the 99th percentile and in the longest tick.",
        );
        vec![chart.sized([1280, 760]).with(panel)]
    }
}

/// An app in which a scene plays.
struct Play {
    app: App,
    scene: Scene,
    has_layers: bool,
}

impl Play {
    fn new(scene: &Scene, has_layers: bool) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default()))
            .init_asset::<Mesh>()
            .add_plugins(DrapePlugins::default())
            .insert_resource(Time::<Fixed>::from_hz(f64::from(RATE)))
            .add_plugins(TimedTicks);
        let layers = Layers(has_layers.then(ClothSelfCollision::default));
        scene.spawn(app.world_mut(), &layers);
        app.finish();
        app.cleanup();
        // Cloth of an asset is built in the second tick.
        (0..3).for_each(|_| app.update());
        let mut play = Self {
            app,
            scene: *scene,
            has_layers,
        };
        play.put();
        play
    }

    /// Puts the particles where the scene begins.
    fn put(&mut self) {
        let world = self.app.world_mut();
        let mut moved = world.query::<(&Moved, &mut ClothParticles, &ClothFrame)>();
        for (Moved(place), mut particles, frame) in moved.iter_mut(world) {
            for index in 0..particles.len() {
                let at = frame.to_world(particles.position(index).expect("it exists"));
                let own = frame.isometry().inverse() * place(at);
                particles.set_position(index, own).expect("it exists");
            }
        }
        world.resource_mut::<Clock>().1.clear();
    }

    /// Plays so many ticks.
    fn row(mut self, ticks: usize, ms_without: f64) -> Row {
        let (mut searches, mut pairs, mut crossed) = (0, 0, 0);
        for tick in 0..ticks {
            follow(self.app.world_mut(), tick as u32);
            self.app.update();
            if self.has_layers {
                crossed = crossed.max(timed::crossed(self.app.world_mut()));
            }
            let world = self.app.world_mut();
            let mut all = world.query::<&ClothStats>();
            searches += all
                .iter(world)
                .map(|stats| stats.layer_searches)
                .max()
                .unwrap_or(0);
            pairs = all
                .iter(world)
                .map(|stats| stats.layer_pairs)
                .fold(pairs, usize::max);
        }
        let world = self.app.world_mut();
        let mut all = world.query::<&ClothParticles>();
        let particles = all.iter(world).map(ClothParticles::len).sum();
        let mut ms = world.resource::<Clock>().1.clone();
        ms.sort_by(f64::total_cmp);
        Row {
            scene: self.scene.name.into(),
            particles,
            layers: self.has_layers.into(),
            ms_per_tick: ms.iter().sum::<f64>() / ms.len() as f64,
            ms_p99: ms[ms.len() * 99 / 100],
            ms_max: ms[ms.len() - 1],
            ms_without,
            searches_per_tick: f64::from(searches) / ticks as f64,
            pairs,
            intersections: crossed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn each_scene_is_played_with_layers_and_without() {
        let columns = "scene,particles,layers,ms_per_tick,ms_p99,ms_max,ms_without,\
                       searches_per_tick,pairs,intersections";
        let rows = quick::<Games>(View::Nothing, columns);
        assert_eq!(rows.len(), 2 * SCENES.len());
        for [without, with] in rows.as_chunks::<2>().0 {
            assert_eq!((without.layers, without.pairs), (0, 0));
            assert_eq!((with.layers, &with.scene), (1, &without.scene));
            assert!(with.particles > 0 && with.particles == without.particles);
        }
        let pairs = rows.iter().filter(|row| row.pairs > 0).count();
        assert!(pairs > 10, "layers touch in {pairs} scenes");
    }
}
