//! The same app without a window: as fast as it can, with a report and a picture.

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
    time::{Duration, Instant},
};

use bevy::{
    prelude::*,
    render::{
        render_resource::TextureFormat,
        renderer::RenderAdapterInfo,
        view::screenshot::{Captured, Screenshot, save_to_disk},
    },
    time::TimeUpdateStrategy,
};
use bevy_drape::{contact::deepest_penetration, plugin::ClothTopology, prelude::*};
use bevy_rapier3d::prelude::PhysicsSet;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::{
    scene::{self, Ball, ScenePlugin},
    view::View,
};

/// Frames that a renderer gets to finish a picture in.
const FRAMES_FOR_A_PICTURE: usize = 60;

/// Fixed ticks that share one update of the app, and with it one idle frame of the renderer: 0.25 s, the most
/// that Bevy's virtual time takes at once.
const TICKS_AN_UPDATE: u64 = 16;

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
    picture: Option<PathBuf>,
    /// Why there is no picture.
    no_picture: Option<String>,
    adapter: Option<String>,
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

/// Simulates `seconds`, prints the report, and saves `ball.png` in `out` if `view` can draw.
pub fn run(view: View, seconds: f64, out: &Path, json: bool) -> ExitCode {
    let mut app = App::new();
    app.add_plugins((view.plugins(), ScenePlugin))
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
    app.finish();
    app.cleanup();

    let timestep = app
        .world()
        .resource::<Time<Fixed>>()
        .timestep()
        .as_secs_f64();
    let ticks = (seconds / timestep).round().max(1.0) as u64;
    let picture_tick = (scene::best_moment(seconds) / timestep).round() as u64;
    let bar = ProgressBar::new(ticks).with_style(
        ProgressStyle::with_template("{bar:40} {pos}/{len} ticks, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    let start = Instant::now();
    let mut drawing = Duration::ZERO;
    let mut picture = None;
    let done = |app: &App| app.world().resource::<Measured>().tick_ms.len() as u64;
    for stop in [picture_tick.clamp(1, ticks), ticks] {
        while done(&app) < stop {
            let together = (stop - done(&app)).min(TICKS_AN_UPDATE) as u32;
            app.insert_resource(TimeUpdateStrategy::FixedTimesteps(together));
            app.update();
            bar.set_position(done(&app));
        }
        if view == View::Offscreen && picture.is_none() {
            let start = Instant::now();
            picture = Some(take_picture(&mut app, out));
            drawing = start.elapsed();
        }
    }
    bar.finish_and_clear();

    let adapter = app
        .world()
        .get_resource::<RenderAdapterInfo>()
        .map(|info| info.name.clone());
    let report = report(
        &mut app,
        ticks,
        seconds,
        (start.elapsed() - drawing).as_secs_f64(),
        picture,
        adapter,
    );
    if json {
        match serde_json::to_string(&report) {
            Ok(text) => println!("{text}"),
            Err(error) => {
                eprintln!("The report could not be written as JSON: {error}");
                return ExitCode::FAILURE;
            }
        }
    } else {
        print_report(&report);
    }
    ExitCode::SUCCESS
}

fn report(
    app: &mut App,
    ticks: u64,
    simulated_seconds: f64,
    wall_seconds: f64,
    picture: Option<Result<PathBuf, String>>,
    adapter: Option<String>,
) -> Report {
    let no_adapter = || Err("no graphics adapter found".into());
    let (picture, no_picture) = match picture.unwrap_or_else(no_adapter) {
        Ok(path) => (Some(path), None),
        Err(why) => (None, Some(why)),
    };
    let mut cloths = app.world_mut().query::<&ClothTopology>();
    let (particles, springs) = cloths
        .iter(app.world())
        .map(|topology| (topology.grid().len(), topology.springs().len()))
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
        no_picture,
        adapter,
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
    let picture = match (&report.picture, &report.adapter, &report.no_picture) {
        (Some(path), Some(adapter), _) => format!("{}, drawn by {adapter}", path.display()),
        (_, _, Some(why)) => format!("none: {why}"),
        _ => "none".into(),
    };
    println!("  picture              {picture}");
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Draws one frame into an image and saves it, while time stands still.
fn take_picture(app: &mut App, out: &Path) -> Result<PathBuf, String> {
    let path = out.join("ball.png");
    fs::create_dir_all(out)
        .map_err(|error| format!("{} could not be made: {error}", out.display()))?;
    // One left by an earlier run must not pass for this one's.
    if path.exists() {
        fs::remove_file(&path)
            .map_err(|error| format!("{} could not be replaced: {error}", path.display()))?;
    }
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    let target = Image::new_target_texture(1280, 720, TextureFormat::Rgba8UnormSrgb, None);
    let target = app.world_mut().resource_mut::<Assets<Image>>().add(target);
    let camera = app
        .world_mut()
        .spawn(scene::camera(Some(target.clone())))
        .id();
    // A few frames, for assets, pipelines and shadows to be ready.
    (0..8).for_each(|_| app.update());
    let screenshot = app
        .world_mut()
        .spawn(Screenshot::image(target))
        .observe(save_to_disk(path.clone()))
        .id();
    for _ in 0..FRAMES_FOR_A_PICTURE {
        app.update();
        let world = app.world();
        if world.get_entity(screenshot).is_err() || world.get::<Captured>(screenshot).is_some() {
            break;
        }
    }
    app.world_mut().despawn(camera);
    if path.is_file() {
        Ok(path)
    } else {
        Err(format!("{} could not be drawn or saved", path.display()))
    }
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
