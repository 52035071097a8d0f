//! What the solver is meant to reach, and what it reaches here: `cargo bench --profile dev --bench targets`.
//!
//! Whatever is compared is timed in turns within one run; each figure is the median of its turns.

mod forms;
#[path = "../shared/mod.rs"]
mod shared;

use std::time::Instant;

use bevy::{ecs::schedule::SingleThreadedExecutor, prelude::*, time::TimeUpdateStrategy};
use bevy_drape::{cloth::SpringKind, prelude::*, solver::Solver};
use shared::{Naive, SUBSTEPS, Scene, in_motion};

/// Turns that each candidate gets.
const TURNS: usize = 15;

fn main() {
    println!(
        "sub-steps: chains of structural and shear springs, no tethers; beside them one sweep of a naive layout; ns a spring\n"
    );
    println!(
        "{:>6} {:>9} {:>9} {:>9} {:>22} {:>15} {:>12}",
        "size", "µs", "ns", "median of", "naive, row by row (ns)", "coloured (ns)", "times naive"
    );
    let mut per_particle = Vec::new();
    for side in [16, 32, 64, 128, 256, 512] {
        let scene = in_motion(side);
        let mut solver = scene.solver(false);
        let mut particles = scene.particles.clone();
        let mut naive = [Naive::new(&scene, false), Naive::new(&scene, true)];
        let springs = scene.springs.len();
        let mut found = [const { Vec::new() }; 3];
        for _ in 0..TURNS {
            particles.clone_from(&scene.particles);
            found[0].push(seconds(|| {
                solver.advance(&mut particles, scene.step(SUBSTEPS), &[], |_, _| false);
            }));
            for (naive, found) in naive.iter_mut().zip(&mut found[1..]) {
                found.push(seconds(|| naive.tick(&scene, 2)) * f64::from(SUBSTEPS) / 2.0);
            }
        }
        let substep = median(&mut found[0]) / f64::from(SUBSTEPS);
        let [_, rows, colours] = &mut found;
        let ns = |seconds: f64| 1.0e9 * seconds / f64::from(SUBSTEPS) / springs as f64;
        let (ours, rows, colours) = (
            1.0e9 * substep / springs as f64,
            ns(median(rows)),
            ns(median(colours)),
        );
        println!(
            "{:>6} {:>9.1} {ours:>9.3} {TURNS:>9} {rows:>22.2} {colours:>15.2} {:>12.1}",
            format!("{side}²"),
            1.0e6 * substep,
            rows / ours
        );
        per_particle.push((side, substep / f64::from(side * side)));
    }
    let of = |side: u32| {
        per_particle
            .iter()
            .find(|(each, _)| *each == side)
            .map_or(0.0, |each| each.1)
    };
    println!(
        "\ngrowth a particle from 64² to 512²: {:.2} ×",
        of(512) / of(64)
    );

    println!(
        "\nhung by two corners, 2 m wide, 3 s at 60 frames a second, tethers; stretch of the last second\n"
    );
    println!(
        "{:>6} {:>10} {:>12} {:>12} {:>9}",
        "size", "sub-steps", "ms a frame", "largest %", "RMS %"
    );
    for (side, substeps) in [
        (32, &[10, 20, 40][..]),
        (64, &[20, 22, 24, 30, 40, 80]),
        (128, &[30, 34, 36, 38, 60]),
    ] {
        for &substeps in substeps {
            hung_by_corners(side, substeps);
        }
    }

    println!(
        "\ntwo partitions of rows, each on its core, against one: {SUBSTEPS} sub-steps, tethers\n"
    );
    for side in [64, 128, 256, 512] {
        let scene = in_motion(side);
        let mut solvers: [Solver; 2] = [1, 2].map(|partitions| {
            let mut solver = scene.solver(true);
            solver.set_partitions(partitions);
            solver
        });
        let mut particles = scene.particles.clone();
        let mut found = [const { Vec::new() }; 2];
        for _ in 0..TURNS {
            for (solver, found) in solvers.iter_mut().zip(&mut found) {
                particles.clone_from(&scene.particles);
                found.push(seconds(|| {
                    solver.advance(&mut particles, scene.step(SUBSTEPS), &[], |_, _| false);
                }));
            }
        }
        let [one, two] = found.each_mut().map(|found| median(found));
        println!(
            "{:>6} {:.3} ms, {:.3} ms: {:.2} ×",
            format!("{side}²"),
            1.0e3 * one,
            1.0e3 * two,
            one / two
        );
    }

    sleep();
    snapshots();
    forms::compare(TURNS);
}

/// A cloth of 64² that moves: taken into the memory of an older snapshot, and put back.
fn snapshots() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, DrapePlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    let cloth = app.world_mut().spawn(Cloth::new(64, 64, 0.03)).id();
    for _ in 0..30 {
        app.update();
    }
    let mut snapshot = ClothSnapshot::of(app.world(), cloth).expect("a cloth");
    let mut found = [const { Vec::new() }; 2];
    for _ in 0..20 * TURNS {
        app.update();
        found[0].push(seconds(|| {
            snapshot.take(app.world(), cloth).expect("a cloth");
        }));
        found[1].push(seconds(|| {
            snapshot.restore(app.world_mut(), cloth).expect("a cloth");
        }));
    }
    let [taken, restored] = found.each_mut().map(|found| 1.0e6 * median(found));
    println!("\nsnapshot of 64²: taken in {taken:.1} µs, restored in {restored:.1} µs");
}

/// When the cloth's systems began in this tick, and how long they took (s).
#[derive(Resource)]
struct Clock(Instant, f64);

/// A cloth of 64² in an app without a renderer: all of its systems in a tick, while it moves and while it sleeps.
fn sleep() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .insert_resource(Clock(Instant::now(), 0.0))
        .edit_schedule(FixedUpdate, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        })
        .add_systems(
            FixedUpdate,
            (
                (|mut clock: ResMut<Clock>| clock.0 = Instant::now()).before(ClothSystems::Prepare),
                (|mut clock: ResMut<Clock>| clock.1 = clock.0.elapsed().as_secs_f64())
                    .after(ClothSystems::WriteBack),
            ),
        );
    let material = ClothMaterial {
        damping: 0.1,
        ..default()
    };
    app.world_mut().spawn((Cloth::new(64, 64, 0.03), material));
    app.finish();
    app.cleanup();
    app.update();
    let (mut awake, mut asleep) = (Vec::new(), Vec::new());
    for _ in 0..2000 {
        app.update();
        let seconds = app.world().resource::<Clock>().1;
        let mut stats = app.world_mut().query::<&ClothStats>();
        if stats.iter(app.world()).all(|stats| stats.is_asleep) {
            asleep.push(seconds);
        } else {
            awake.push(seconds);
        }
    }
    let [awake, asleep] = [&mut awake, &mut asleep].map(|each| 1.0e6 * median(each));
    println!("\na cloth of 64² in the plugin, 20 sub-steps: all of its systems in a tick\n");
    println!(
        "awake {awake:.1} µs, asleep {asleep:.2} µs: {:.2} % of it",
        100.0 * asleep / awake
    );
}

fn hung_by_corners(side: u32, substeps: u32) {
    let scene = Scene::hung_by_corners(side, 2.0).expect("a valid scene");
    let structural: Vec<_> = scene
        .springs
        .to_vec()
        .into_iter()
        .filter(|spring| spring.kind == SpringKind::Structural)
        .collect();
    let mut solver = scene.solver(true);
    let mut particles = scene.particles.clone();
    let (mut times, mut largest, mut squares) = (Vec::new(), 0.0_f32, 0.0);
    for frame in 0..180 {
        let mut stretch = Default::default();
        times.push(seconds(|| {
            stretch = solver.advance(&mut particles, scene.step(substeps), &[], |_, _| false);
        }));
        if frame >= 120 {
            largest = largest.max(stretch.structural);
            for spring in &structural {
                let [a, b] = spring.ends.map(|end| particles.position(end as usize));
                let length = a.zip(b).map_or(0.0, |(a, b)| a.distance(b));
                squares += f64::from(length / spring.rest_length - 1.0).powi(2);
            }
        }
    }
    println!(
        "{:>6} {substeps:>10} {:>12.3} {:>12.2} {:>9.3}",
        format!("{side}²"),
        1.0e3 * median(&mut times),
        100.0 * largest,
        100.0 * (squares / (60 * structural.len()) as f64).sqrt()
    );
}

/// How long it takes (s).
pub fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// The middle one.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
