//! The same app without a window: a report on each mesh, and a picture of each.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use examples_shared::headless::{Picture, Run};
use examples_shared::{measured::median, report::print, stage::Shot};
use serde::Serialize;

/// The pictures: each cloth by itself.
const SHOTS: [(&str, Shot); 3] = [
    (
        "pennant",
        Shot {
            from: Vec3::new(-3.0, 1.3, 4.4),
            focus: Vec3::new(-3.4, 1.3, 0.15),
            fov: 0.46,
        },
    ),
    (
        "poncho",
        Shot {
            from: Vec3::new(-0.4, 1.9, 3.9),
            focus: Vec3::new(-0.6, 1.06, 0.5),
            fov: 0.44,
        },
    ),
    (
        "ridge_tent",
        Shot {
            from: Vec3::new(6.7, 1.7, 2.3),
            focus: Vec3::new(3.1, 0.5, -0.1),
            fov: 0.48,
        },
    ),
];

/// The printed report.
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

/// Simulates, prints the report, and saves a picture of each cloth.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .register_required_components::<Cloth, Measured>()
        .add_systems(FixedLast, measure);
    let figures = run.finish();
    let pictures = SHOTS.map(|(name, shot)| {
        run.example.name = name;
        run.example.shot = shot;
        run.picture()
    });
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
    let mut cloths: Vec<Row> = cloths.iter_mut(world).map(row).collect();
    cloths.sort_by(|one, other| one.name.cmp(&other.name));
    let is_whole = cloths
        .iter()
        .all(|row| row.fault.is_none() && row.particles > 0);
    let report = Report {
        ticks: figures.ticks,
        cloths,
        pictures: pictures.into(),
    };
    let code = print(&report, run.options.json, print_report);
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
