//! The same app without a window: a report on each mesh, and a picture of each.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::{
    plugin::{ClothBuilt, ClothFault},
    prelude::*,
};
use serde::Serialize;

use crate::{
    scene::{SHOTS, ScenePlugin},
    shared::{
        headless::{Picture, Run, median, print},
        stage::Grid,
        start::Options,
        view::View,
    },
};

/// What is printed.
#[derive(Serialize)]
struct Report {
    ticks: u64,
    cloths: Vec<Row>,
    pictures: Vec<Picture>,
}

/// One cloth.
#[derive(Serialize)]
struct Row {
    name: String,
    vertices: usize,
    particles: usize,
    springs: usize,
    pinned: usize,
    /// Median over all ticks.
    solver_ms: f64,
    largest_stretch_percent: f32,
    asleep: bool,
    /// What is wrong with it, if it is left out.
    fault: Option<String>,
}

#[derive(Component, Default)]
struct Measured {
    solver_ms: Vec<f64>,
    largest_stretch: f32,
}

fn measure(mut cloths: Query<(&ClothStats, &mut Measured)>) {
    for (stats, mut measured) in &mut cloths {
        if stats.substeps > 0 {
            measured.solver_ms.push(stats.integrate_ms);
        }
        measured.largest_stretch = measured.largest_stretch.max(stats.stretch.structural);
    }
}

/// Simulates, prints the report, and saves a picture of each cloth if `view` can draw.
pub fn run(view: View, fineness: Grid, options: &Options) -> ExitCode {
    let scene = ("meshes as cloth", ScenePlugin);
    let mut run = Run::new(scene, view, fineness, options, |app| {
        app.register_required_components::<Cloth, Measured>()
            .add_systems(FixedLast, measure);
    });
    run.finish();
    let pictures = SHOTS.map(|(file, shot)| run.take_picture(shot, &options.out, file));
    let world = run.app.world_mut();
    let mut cloths = world.query::<(
        &Name,
        &ClothBuilt,
        &ClothParticles,
        &ClothStats,
        &mut Measured,
        Option<&ClothFault>,
    )>();
    let row = |(name, built, particles, stats, mut measured, fault): (
        &Name,
        &ClothBuilt,
        &ClothParticles,
        &ClothStats,
        Mut<Measured>,
        Option<&ClothFault>,
    )| Row {
        name: name.to_string(),
        vertices: built.surface().vertices(),
        particles: particles.len(),
        springs: built.springs().len(),
        pinned: particles
            .inverse_masses()
            .filter(|mass| *mass == 0.0)
            .count(),
        solver_ms: median(&mut measured.solver_ms),
        largest_stretch_percent: 100.0 * measured.largest_stretch,
        asleep: stats.is_asleep,
        fault: fault.map(|fault| fault.error.to_string()),
    };
    let cloths: Vec<Row> = cloths.iter_mut(world).map(row).collect();
    let is_whole = cloths
        .iter()
        .all(|row| row.fault.is_none() && row.particles > 0);
    let report = Report {
        ticks: run.ticks,
        cloths,
        pictures: pictures.into(),
    };
    let code = print(&report, options.json, print_report);
    if is_whole { code } else { ExitCode::FAILURE }
}

fn print_report(report: &Report) {
    println!("Meshes as cloth, headless");
    println!("  ticks    {}", report.ticks);
    println!(
        "  {:<9} {:>8} {:>9} {:>8} {:>7} {:>10} {:>11}",
        "", "vertices", "particles", "springs", "pinned", "solver, ms", "stretch, %"
    );
    for row in &report.cloths {
        println!(
            "  {:<9} {:>8} {:>9} {:>8} {:>7} {:>10.3} {:>11.2}",
            row.name,
            row.vertices,
            row.particles,
            row.springs,
            row.pinned,
            row.solver_ms,
            row.largest_stretch_percent
        );
        if let Some(fault) = &row.fault {
            println!("            left out: {fault}");
        }
    }
    for picture in &report.pictures {
        println!("  picture  {picture}");
    }
}
