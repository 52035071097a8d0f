//! The same app without a window: a report of the folds, and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use serde::Serialize;

use crate::{
    scene::{self, Crossings, ScenePlugin},
    shared::{
        headless::{Picture, Run, median, print, ticks_in},
        stage::Grid,
        start::Options,
        view::View,
    },
};

/// What is printed.
#[derive(Serialize)]
struct Report {
    ticks: u64,
    simulated_seconds: f64,
    particles: usize,
    /// The most triangles that passed through each other after any tick: pairs.
    crossings: usize,
    counts: u32,
    /// The most pairs of features near each other, and how often they were searched for, in all.
    pairs: usize,
    searches: u64,
    /// Medians over the ticks in which it was awake.
    solver_ms: f64,
    largest_stretch_percent: f32,
    /// Height of the pile (mm).
    height_mm: f32,
    is_asleep: bool,
    #[serde(flatten)]
    picture: Picture,
}

#[derive(Resource, Default)]
struct Measured {
    pairs: usize,
    searches: u64,
    solver_ms: Vec<f64>,
    largest_stretch: f32,
}

/// Simulates, prints the report, and saves `fold.png` if `view` can draw.
pub fn run(view: View, grid: Grid, options: &Options) -> ExitCode {
    let mut app = App::new();
    app.add_plugins((view.plugins("folds"), ScenePlugin))
        .insert_resource(grid)
        .init_resource::<Measured>()
        .add_systems(FixedLast, measure);
    app.world_mut().resource_mut::<Crossings>().is_thorough = true;
    let ticks = ticks_in(&app, options.seconds).max(1);
    let mut run = Run::new(app, view, ticks);
    run.until(ticks);
    let picture = run.take_picture(scene::SHOT, &options.out, "fold.png");

    let world = run.app.world_mut();
    let mut cloths = world.query::<(&ClothParticles, &ClothFrame, &ClothStats)>();
    let (mut particles, mut height, mut is_asleep) = (0, 0.0_f32, true);
    for (cloth, frame, stats) in cloths.iter(world) {
        particles += cloth.len();
        is_asleep &= stats.is_asleep;
        let heights = cloth.positions().map(|place| frame.to_world(place).y);
        height = heights.fold(height, f32::max);
    }
    let (most, counts) = {
        let crossings = world.resource::<Crossings>();
        (crossings.most, crossings.counts)
    };
    let mut measured = world.resource_mut::<Measured>();
    let report = Report {
        ticks,
        simulated_seconds: options.seconds,
        particles,
        crossings: most,
        counts,
        pairs: measured.pairs,
        searches: measured.searches,
        solver_ms: median(&mut measured.solver_ms),
        largest_stretch_percent: 100.0 * measured.largest_stretch,
        height_mm: 1.0e3 * height,
        is_asleep,
        picture,
    };
    print(&report, options.json, print_report)
}

fn print_report(report: &Report) {
    println!("A cloth let down into folds, headless");
    println!(
        "  cloth          {} particles, stretched by {:.2} % at most",
        report.particles, report.largest_stretch_percent
    );
    println!(
        "  ticks          {} ({} s simulated)",
        report.ticks, report.simulated_seconds
    );
    println!(
        "  intersections  {} pairs of triangles at most, counted {} times by brute force",
        report.crossings, report.counts
    );
    println!(
        "  contact        {} pairs of features near each other at most, searched for {} times",
        report.pairs, report.searches
    );
    println!("  a tick         {:.3} ms (median)", report.solver_ms);
    let sleeps = if report.is_asleep { ", asleep" } else { "" };
    println!("  the pile       {:.0} mm high{sleeps}", report.height_mm);
    println!("  picture        {}", report.picture);
}

fn measure(cloths: Query<&ClothStats>, mut measured: ResMut<Measured>) {
    for stats in &cloths {
        measured.pairs = measured.pairs.max(stats.layer_pairs);
        measured.searches += u64::from(stats.layer_searches);
        if !stats.is_asleep {
            measured.solver_ms.push(stats.integrate_ms);
        }
        measured.largest_stretch = measured.largest_stretch.max(stats.stretch.structural);
    }
}
