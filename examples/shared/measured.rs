//! Measurements of every cloth during a run, and the first lines of each report.

use std::time::Instant;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use serde::Serialize;

use super::headless::Run;

/// Figures of the cloths that every report has.
#[derive(Serialize)]
pub struct Figures {
    pub ticks: u64,
    pub simulated_seconds: f64,
    wall_seconds: f64,
    particles: usize,
    /// The most of any tick.
    substeps: u32,
    /// The solver's call alone, contact included: in the median, of the ticks in which a cloth was awake.
    pub solver_ms: f64,
    /// Of a tick, from `FixedFirst` to `FixedPostUpdate`, once the cloths are built: in the median, the 99th percentile, and at most.
    tick_ms: f64,
    tick_ms_p99: f64,
    tick_ms_longest: f64,
    largest_stretch_percent: f32,
    is_asleep: bool,
    /// The most particles that touched in any tick: for reports that say so.
    #[serde(skip)]
    pub contacts: usize,
}

#[derive(Resource, Default)]
struct Measured {
    solver_ms: Vec<f64>,
    tick_ms: Vec<f64>,
    substeps: u32,
    largest_stretch: f32,
    contacts: usize,
}

/// Measures each tick.
pub struct MeasuringPlugin;

impl Plugin for MeasuringPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Measured>()
            .init_resource::<TickTime>()
            .add_systems(FixedFirst, begin_tick)
            .add_systems(FixedPostUpdate, end_tick)
            .add_systems(FixedLast, measure);
    }
}

/// How long the tick took, but for measurements, which are in `FixedLast`.
#[derive(Resource, Default)]
pub struct TickTime {
    began: Option<Instant>,
    pub ms: f64,
}

fn begin_tick(mut tick: ResMut<TickTime>) {
    tick.began = Some(Instant::now());
}

fn end_tick(mut tick: ResMut<TickTime>) {
    let seconds = tick
        .began
        .map_or(0.0, |began| began.elapsed().as_secs_f64());
    tick.ms = 1000.0 * seconds;
}

fn measure(
    cloths: Query<(&ClothStats, &ClothParticles)>,
    tick: Res<TickTime>,
    mut were_built: Local<bool>,
    mut measured: ResMut<Measured>,
) {
    let are_built = !cloths.is_empty() && cloths.iter().all(|(_, of)| !of.is_empty());
    if std::mem::replace(&mut *were_built, are_built) {
        measured.tick_ms.push(tick.ms);
    }
    let (mut solver_ms, mut contacts) = (0.0, 0);
    for (stats, _) in &cloths {
        if !stats.is_asleep {
            solver_ms += stats.integrate_ms;
        }
        measured.substeps = measured.substeps.max(stats.substeps);
        measured.largest_stretch = measured.largest_stretch.max(stats.stretch.structural);
        contacts += stats.contacts;
    }
    measured.contacts = measured.contacts.max(contacts);
    if solver_ms > 0.0 {
        measured.solver_ms.push(solver_ms);
    }
}

impl Figures {
    /// Of all that a run has done.
    pub(super) fn of(run: &mut Run) -> Self {
        let (ticks, wall_seconds) = (run.ticks, run.wall_seconds);
        let timestep = run.app.world().resource::<Time<Fixed>>().timestep();
        let simulated_seconds = ticks as f64 * timestep.as_secs_f64();
        let world = run.app.world_mut();
        let mut cloths = world.query::<(&ClothParticles, &ClothStats)>();
        let particles = cloths.iter(world).map(|(cloth, _)| cloth.len()).sum();
        let is_asleep = cloths.iter(world).all(|(_, stats)| stats.is_asleep);
        let mut measured = world.resource_mut::<Measured>();
        let solver_ms = median(&mut measured.solver_ms);
        let [tick_ms, tick_ms_p99, tick_ms_longest] =
            [0.5, 0.99, 1.0].map(|part| quantile(&mut measured.tick_ms, part));
        Self {
            ticks,
            simulated_seconds,
            wall_seconds,
            particles,
            substeps: measured.substeps,
            solver_ms,
            tick_ms,
            tick_ms_p99,
            tick_ms_longest,
            largest_stretch_percent: 100.0 * measured.largest_stretch,
            is_asleep,
            contacts: measured.contacts,
        }
    }

    /// Prints them below a title.
    pub fn print(&self, title: &str) {
        println!("{title}, headless");
        println!(
            "  cloth            {} particles, {} sub-steps a tick at most{}",
            self.particles,
            self.substeps,
            if self.is_asleep { ", asleep" } else { "" }
        );
        println!(
            "  ticks            {} ({} s simulated in {:.2} s, {:.1} × real time)",
            self.ticks,
            self.simulated_seconds,
            self.wall_seconds,
            self.simulated_seconds / self.wall_seconds
        );
        println!(
            "  solver           {:.3} ms a tick (median while awake)",
            self.solver_ms
        );
        println!(
            "  all of a tick    {:.1} ms in the median, {:.1} ms in the 99th percentile, {:.1} ms at most",
            self.tick_ms, self.tick_ms_p99, self.tick_ms_longest
        );
        println!("  largest stretch  {:.2} %", self.largest_stretch_percent);
    }
}

/// The value in the middle; 0 of none.
pub fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// The value below which this part of them is, from 0 to 1; 0 of none.
fn quantile(values: &mut [f64], part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = (part * values.len() as f64) as usize;
    let at = at.min(values.len().saturating_sub(1));
    values.get(at).copied().unwrap_or(0.0)
}
