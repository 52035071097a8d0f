//! The same app without a window, as fast as possible: a report and a picture.

use std::{process::ExitCode, time::Instant};

use bevy::prelude::*;
use bevy_drape::{contact::deepest_penetration, plugin::ClothBuilt, prelude::*};
use bevy_rapier3d::prelude::PhysicsSet;
use serde::Serialize;

use crate::{
    measured::{Figures, MeasuringPlugin},
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
    #[serde(flatten)]
    figures: Figures,
    springs: usize,
    /// All of `FixedUpdate`.
    tick_ms: f64,
    /// Rapier's part of it.
    rapier_ms: f64,
    /// The cloth's five system sets.
    cloth_ms: f64,
    /// Largest number of particles that touched.
    contacts: usize,
    nodes_visited: usize,
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
    contacts: usize,
    nodes_visited: usize,
    deepest: f32,
    deepest_left: f64,
}

/// How far the ball is past the cloth's plane (m) when the cloth is well wrapped around it.
const WRAPPED: f32 = 1.2;

/// Simulates, prints the report, and saves `ball.png` if `view` can draw.
pub fn run(view: View, grid: Grid, options: &Options) -> ExitCode {
    let scene = ("the ball and the cloth", ScenePlugin);
    let mut run = Run::new(scene, view, grid, options, |app| {
        app.add_plugins(MeasuringPlugin)
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
    });
    let moment = scene::moment_beyond(WRAPPED, options.seconds);
    run.until(ticks_in(&run.app, moment).clamp(1, run.ticks));
    let picture = run.take_picture(scene::SHOT, &options.out, "ball.png");
    run.finish();
    let figures = Figures::of(&mut run);
    let world = run.app.world_mut();
    let mut cloths = world.query::<&ClothBuilt>();
    let springs = cloths.iter(world).map(|built| built.springs().len()).sum();
    let mut measured = world.resource_mut::<Measured>();
    let report = Report {
        figures,
        springs,
        tick_ms: median(&mut measured.tick_ms),
        rapier_ms: median(&mut measured.rapier_ms),
        cloth_ms: median(&mut measured.cloth_ms),
        contacts: measured.contacts,
        nodes_visited: measured.nodes_visited,
        deepest_penetration_mm: 1.0e3 * measured.deepest,
        deepest_left_mm: 1.0e3 * measured.deepest_left,
        picture,
    };
    print(&report, options.json, print_report)
}

fn print_report(report: &Report) {
    let over = |milliseconds| 100.0 * (milliseconds / report.figures.solver_ms - 1.0);
    report.figures.print("A ball and a cloth");
    println!("  springs          {}", report.springs);
    println!(
        "  whole tick       {:.4} ms: cloth systems {:.4} ms, rapier {:.4} ms (medians)",
        report.tick_ms, report.cloth_ms, report.rapier_ms
    );
    println!(
        "  over the solver  {:.0} % more for the cloth systems, {:.0} % more for the whole tick",
        over(report.cloth_ms),
        over(report.tick_ms)
    );
    println!(
        "  contacts         at most {} particles, {} nodes visited",
        report.contacts, report.nodes_visited
    );
    println!(
        "  penetration      at most {:.2} mm before the response, {:.4} mm after a tick",
        report.deepest_penetration_mm, report.deepest_left_mm
    );
    println!("  picture          {}", report.picture);
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
        measured.contacts = measured.contacts.max(stats.contacts);
        measured.nodes_visited = measured.nodes_visited.max(stats.nodes_visited);
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
