//! The same app without a window: as fast as it can, with a report and a picture.

use std::{process::ExitCode, time::Instant};

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::Velocity;
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

/// What is printed.
#[derive(Serialize)]
struct Report {
    ticks: u64,
    simulated_seconds: f64,
    wall_seconds: f64,
    particles: usize,
    ball_kg: f32,
    cloth_kg: f64,
    /// The solver's call alone, in the median.
    solver_ms: f64,
    /// How high the ball got again after it first fell into the hammock (m).
    bounce_m: f32,
    /// Where the ball is at last (m), and how far it moved and how fast it was in the last second (mm, mm/s).
    height_m: f32,
    last_moves_mm: f32,
    last_speed_mm_s: f32,
    largest_stretch_percent: f32,
    #[serde(flatten)]
    picture: Picture,
}

/// What is measured on the way.
#[derive(Resource, Default)]
struct Measured {
    solver_ms: Vec<f64>,
    places: Vec<Vec3>,
    speeds: Vec<f32>,
    largest_stretch: f32,
}

/// Simulates, prints the report, and saves `hammock.png` if `view` can draw.
pub fn run(view: View, grid: Grid, options: &Options) -> ExitCode {
    let mut app = App::new();
    app.add_plugins((view.plugins("a ball in a hammock"), ScenePlugin))
        .insert_resource(grid)
        .init_resource::<Measured>()
        .add_systems(FixedLast, measure);
    let ticks = ticks_in(&app, options.seconds).max(1);
    let mut run = Run::new(app, view, ticks);
    let start = Instant::now();
    run.until(ticks);
    let wall_seconds = start.elapsed().as_secs_f64();
    let picture = run.take_picture(scene::SHOT, &options.out, "hammock.png");
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
    let second = ticks_in(app, 1.0) as usize;
    let mut cloths = app.world_mut().query::<&ClothParticles>();
    let cloth = cloths.iter(app.world()).next();
    let (particles, cloth_kg) = cloth.map_or((0, 0.0), |particles| {
        let masses = particles.inverse_masses().filter(|w| *w > 0.0);
        (particles.len(), masses.map(|w| 1.0 / f64::from(w)).sum())
    });
    let mut measured = app.world_mut().resource_mut::<Measured>();
    let solver_ms = median(&mut measured.solver_ms);
    let heights: Vec<f32> = measured.places.iter().map(|place| place.y).collect();
    // The first time that it goes up again, and how high it gets from there.
    let turn = heights.windows(2).position(|pair| pair[1] > pair[0]);
    let after = turn.map_or(&[][..], |turn| &heights[turn..]);
    let lowest = after.first().copied().unwrap_or(f32::NAN);
    let highest = after.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let last = measured.places.len().saturating_sub(second);
    let (low, high) = measured.places[last..]
        .iter()
        .fold((Vec3::MAX, Vec3::MIN), |(low, high), place| {
            (low.min(*place), high.max(*place))
        });
    Report {
        ticks,
        simulated_seconds,
        wall_seconds,
        particles,
        ball_kg: scene::MASS,
        cloth_kg,
        solver_ms,
        bounce_m: highest - lowest,
        height_m: heights.last().copied().unwrap_or(f32::NAN),
        last_moves_mm: 1.0e3 * high.distance(low),
        last_speed_mm_s: 1.0e3 * measured.speeds[last..].iter().copied().fold(0.0, f32::max),
        largest_stretch_percent: 100.0 * measured.largest_stretch,
        picture,
    }
}

fn print_report(report: &Report) {
    let speed = report.simulated_seconds / report.wall_seconds;
    println!("A ball in a hammock, headless");
    println!(
        "  ticks            {} ({} s simulated in {:.2} s, {speed:.0} × real time), solver {:.3} ms a tick in the median",
        report.ticks, report.simulated_seconds, report.wall_seconds, report.solver_ms
    );
    println!(
        "  masses           ball {} kg, cloth {:.2} kg of {} particles",
        report.ball_kg, report.cloth_kg, report.particles
    );
    println!("  bounce           {:.2} m", report.bounce_m);
    println!(
        "  at last          {:.3} m high, {:.2} mm moved and {:.1} mm/s fast in the last second",
        report.height_m, report.last_moves_mm, report.last_speed_mm_s
    );
    println!("  largest stretch  {:.2} %", report.largest_stretch_percent);
    println!("  picture          {}", report.picture);
}

fn measure(
    cloths: Query<&ClothStats>,
    balls: Query<(&Transform, &Velocity), With<Ball>>,
    mut measured: ResMut<Measured>,
) {
    for stats in &cloths {
        measured.solver_ms.push(stats.integrate_ms);
        measured.largest_stretch = measured.largest_stretch.max(stats.stretch.structural);
    }
    for (transform, velocity) in &balls {
        measured.places.push(transform.translation);
        measured.speeds.push(velocity.linear.length());
    }
}
