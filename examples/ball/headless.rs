//! The same app without a window: as fast as it can, with a report and a picture.

use std::{process::ExitCode, time::Instant};

use bevy::prelude::*;
use bevy_drape::{contact::deepest_penetration, plugin::ClothBuilt, prelude::*};
use bevy_rapier3d::prelude::PhysicsSet;
use serde::Serialize;

use crate::{
    scene::{self, Ball, ScenePlugin},
    shared::{
        headless::{Picture, Run, median, print, ticks_in},
        stage::Grid,
        start::Options,
        view::View,
    },
};

/// What is printed: times are medians over all ticks, the rest is the largest of any tick.
#[derive(Serialize)]
struct Report {
    ticks: u64,
    simulated_seconds: f64,
    wall_seconds: f64,
    particles: usize,
    springs: usize,
    /// The most of any tick.
    substeps: u32,
    /// All of `FixedUpdate`.
    tick_ms: f64,
    /// Rapier's part of it.
    rapier_ms: f64,
    /// The cloth's five system sets.
    cloth_ms: f64,
    /// The solver's call alone.
    solver_ms: f64,
    /// Largest number of particles that touched.
    contacts: usize,
    nodes_visited: usize,
    largest_stretch_percent: f32,
    /// How deep a particle was found in the ball before it was pushed out.
    deepest_penetration_mm: f32,
    /// How deep any particle was at the end of a tick, by brute force in f64.
    deepest_left_mm: f64,
    #[serde(flatten)]
    picture: Picture,
}

/// What is measured on the way.
#[derive(Resource, Default)]
struct Measured {
    tick_start: Option<Instant>,
    cloth_start: Option<Instant>,
    tick_ms: Vec<f64>,
    rapier_ms: Vec<f64>,
    cloth_ms: Vec<f64>,
    solver_ms: Vec<f64>,
    contacts: usize,
    nodes_visited: usize,
    substeps: u32,
    largest_stretch: f32,
    deepest: f32,
    deepest_left: f64,
}

/// How far the ball is past the cloth's plane (m) when the cloth is well wrapped around it.
const WRAPPED: f32 = 1.2;

/// Simulates, prints the report, and saves `ball.png` if `view` can draw.
pub fn run(view: View, grid: Grid, options: &Options) -> ExitCode {
    let mut app = App::new();
    app.add_plugins((view.plugins("the ball and the cloth"), ScenePlugin))
        .insert_resource(grid)
        .init_resource::<Measured>()
        .add_systems(
            FixedUpdate,
            (
                start_tick.before(scene::drive_ball),
                start_cloth
                    .after(PhysicsSet::Writeback)
                    .before(ClothSystems::Prepare),
                end_tick.after(ClothSystems::WriteBack),
            ),
        )
        .add_systems(FixedLast, look_at_the_worst);
    let ticks = ticks_in(&app, options.seconds).max(1);
    let picture_tick =
        ticks_in(&app, scene::moment_beyond(WRAPPED, options.seconds)).clamp(1, ticks);
    let mut run = Run::new(app, view, ticks);
    let start = Instant::now();
    run.until(picture_tick);
    let before = Instant::now();
    let picture = run.take_picture(scene::SHOT, &options.out, "ball.png");
    let drawing = before.elapsed();
    run.until(ticks);
    let wall_seconds = (start.elapsed() - drawing).as_secs_f64();
    let report = report(&mut run.app, ticks, options.seconds, wall_seconds, picture);
    print(&report, options.json, print_report)
}

fn report(
    app: &mut App,
    ticks: u64,
    simulated_seconds: f64,
    wall_seconds: f64,
    picture: Picture,
) -> Report {
    let mut cloths = app.world_mut().query::<&ClothBuilt>();
    let (particles, springs) = cloths
        .iter(app.world())
        .map(|built| (built.surface().len(), built.springs().len()))
        .next()
        .unwrap_or_default();
    let mut measured = app.world_mut().resource_mut::<Measured>();
    Report {
        ticks,
        simulated_seconds,
        wall_seconds,
        particles,
        springs,
        substeps: measured.substeps,
        tick_ms: median(&mut measured.tick_ms),
        rapier_ms: median(&mut measured.rapier_ms),
        cloth_ms: median(&mut measured.cloth_ms),
        solver_ms: median(&mut measured.solver_ms),
        contacts: measured.contacts,
        nodes_visited: measured.nodes_visited,
        largest_stretch_percent: 100.0 * measured.largest_stretch,
        deepest_penetration_mm: 1.0e3 * measured.deepest,
        deepest_left_mm: 1.0e3 * measured.deepest_left,
        picture,
    }
}

fn print_report(report: &Report) {
    let speed = report.simulated_seconds / report.wall_seconds;
    let over = |milliseconds| 100.0 * (milliseconds / report.solver_ms - 1.0);
    println!("The ball and the cloth, headless");
    println!(
        "  cloth                {} particles, {} springs, {} sub-steps a tick at most",
        report.particles, report.springs, report.substeps
    );
    println!(
        "  ticks                {} ({} s simulated in {:.2} s, {speed:.0} × real time)",
        report.ticks, report.simulated_seconds, report.wall_seconds
    );
    println!(
        "  a tick (median)      {:.4} ms: solver {:.4} ms, cloth's systems in all {:.4} ms, rapier {:.4} ms",
        report.tick_ms, report.solver_ms, report.cloth_ms, report.rapier_ms
    );
    println!(
        "  beyond the solver    {:.0} % for the cloth's systems, {:.0} % for the whole tick",
        over(report.cloth_ms),
        over(report.tick_ms)
    );
    println!(
        "  contacts             {} particles at most, {} nodes visited at most",
        report.contacts, report.nodes_visited
    );
    println!(
        "  largest stretch      {:.2} %",
        report.largest_stretch_percent
    );
    println!(
        "  deepest penetration  {:.2} mm found within a tick, {:.4} mm left after one",
        report.deepest_penetration_mm, report.deepest_left_mm
    );
    println!("  picture              {}", report.picture);
}

fn start_tick(mut measured: ResMut<Measured>) {
    measured.tick_start = Some(Instant::now());
}

fn start_cloth(mut measured: ResMut<Measured>) {
    let now = Instant::now();
    measured.cloth_start = Some(now);
    if let Some(start) = measured.tick_start {
        measured.rapier_ms.push((now - start).as_secs_f64() * 1.0e3);
    }
}

fn end_tick(mut measured: ResMut<Measured>) {
    let now = Instant::now();
    if let (Some(tick), Some(cloth)) = (measured.tick_start, measured.cloth_start) {
        measured.tick_ms.push((now - tick).as_secs_f64() * 1.0e3);
        measured.cloth_ms.push((now - cloth).as_secs_f64() * 1.0e3);
    }
}

fn look_at_the_worst(
    cloths: Query<(
        &ClothStats,
        &ClothContacts,
        &ClothFrame,
        &ClothParticles,
        &ClothSettings,
    )>,
    balls: Query<(&Transform, &ClothCollider), With<Ball>>,
    mut measured: ResMut<Measured>,
) {
    for (stats, contacts, frame, particles, settings) in &cloths {
        measured.solver_ms.push(stats.integrate_ms);
        measured.contacts = measured.contacts.max(stats.contacts);
        measured.substeps = measured.substeps.max(stats.substeps);
        measured.nodes_visited = measured.nodes_visited.max(stats.nodes_visited);
        measured.largest_stretch = measured.largest_stretch.max(stats.stretch.structural);
        for contact in contacts.iter() {
            measured.deepest = measured.deepest.max(contact.deepest_penetration);
        }
        for (transform, collider) in &balls {
            if let Ok(shape) = collider.scaled(transform.scale) {
                let pose = Isometry3d::from_translation(frame.from_world(transform.translation));
                let left = deepest_penetration(particles, &shape, pose, settings.particle_radius);
                measured.deepest_left = measured.deepest_left.max(left);
            }
        }
    }
}
