//! The same app without a window, as fast as possible: a report and a picture.

use std::{process::ExitCode, time::Instant};

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::PhysicsSet;
use examples_shared::{depth::Placed, report::Report};
use examples_shared::{headless::Run, measured::median};
use serde::Serialize;

use crate::scene::{self, Ball};

/// The printed report: times are medians over all ticks, the rest is the largest of any tick.
#[derive(Serialize)]
struct Own {
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
}

/// Measurements of each tick.
#[derive(Resource, Default)]
struct Measured {
    tick_start: Option<Instant>,
    cloth_start: Option<Instant>,
    tick_ms: Vec<f64>,
    rapier_ms: Vec<f64>,
    cloth_ms: Vec<f64>,
    nodes_visited: usize,
    deepest: f32,
    deepest_left_mm: f64,
}

/// How far the ball is past the cloth's plane (m) when the cloth is well wrapped around it.
const WRAPPED: f32 = 1.2;

/// Simulates, prints the report, and saves `ball.png`.
pub fn report(mut run: Run) -> ExitCode {
    let measuring = (
        start_tick.before(scene::drive_ball),
        start_cloth
            .after(PhysicsSet::Writeback)
            .before(ClothSystems::Prepare),
        end_tick.after(ClothSystems::WriteBack),
    );
    run.app
        .init_resource::<Measured>()
        .add_systems(FixedUpdate, measuring)
        .add_systems(FixedLast, look_at_the_worst);
    run.example.drawn_at = scene::moment_beyond(WRAPPED, run.options.seconds);
    let picture = run.picture();
    let figures = run.finish();
    let world = run.app.world_mut();
    let mut cloths = world.query::<&ClothBuilt>();
    let springs = cloths.iter(world).map(|built| built.springs().len()).sum();
    let mut measured = world.resource_mut::<Measured>();
    let own = Own {
        springs,
        tick_ms: median(&mut measured.tick_ms),
        rapier_ms: median(&mut measured.rapier_ms),
        cloth_ms: median(&mut measured.cloth_ms),
        contacts: figures.contacts,
        nodes_visited: measured.nodes_visited,
        deepest_penetration_mm: 1.0e3 * measured.deepest,
        deepest_left_mm: measured.deepest_left_mm,
    };
    let report = Report {
        title: "A ball and a cloth",
        figures,
        own,
        picture: Some(picture),
    };
    report.print(&mut run, print_own)
}

fn print_own(Report { figures, own, .. }: &Report<Own>) {
    let over = |milliseconds| 100.0 * (milliseconds / figures.solver_ms - 1.0);
    println!("  springs          {}", own.springs);
    println!(
        "  whole tick       {:.4} ms: cloth systems {:.4} ms, rapier {:.4} ms (medians)",
        own.tick_ms, own.cloth_ms, own.rapier_ms
    );
    println!(
        "  over the solver  {:.0} % more for the cloth systems, {:.0} % more for the whole tick",
        over(own.cloth_ms),
        over(own.tick_ms)
    );
    println!(
        "  contacts         at most {} particles, {} nodes visited",
        own.contacts, own.nodes_visited
    );
    println!(
        "  penetration      at most {:.2} mm before the response, {:.4} mm after a tick",
        own.deepest_penetration_mm, own.deepest_left_mm
    );
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
    cloths: Query<(&ClothStats, &ClothContacts, Placed)>,
    balls: Query<(&Transform, &ClothCollider), With<Ball>>,
    mut measured: ResMut<Measured>,
) {
    for (stats, contacts, cloth) in &cloths {
        measured.nodes_visited = measured.nodes_visited.max(stats.nodes_visited);
        for contact in contacts.iter() {
            measured.deepest = measured.deepest.max(contact.deepest_penetration);
        }
        for (transform, collider) in &balls {
            let left = cloth.depth_in(collider, transform);
            measured.deepest_left_mm = measured.deepest_left_mm.max(left);
        }
    }
}
