//! Measurements of apps: the time of each tick, and the intersections of cloths after it.

use std::time::Instant;

use bevy::{ecs::schedule::SingleThreadedExecutor, prelude::*, time::TimeUpdateStrategy};
use bevy_drape::{contact::intersections, plugin::ClothBuilt, prelude::*};

/// Runs one fixed tick in each update, its systems one after the other, and times all of the plugin's systems.
pub struct TimedTicks;

impl Plugin for TimedTicks {
    fn build(&self, app: &mut App) {
        app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
            .insert_resource(Clock(Instant::now(), Vec::new()))
            .edit_schedule(FixedUpdate, |schedule| {
                schedule.set_executor(SingleThreadedExecutor::new());
            })
            .add_systems(
                FixedUpdate,
                (
                    start.before(ClothSystems::Prepare),
                    stop.after(ClothSystems::WriteBack),
                ),
            );
    }
}

/// When the last fixed tick began, and how long each took (ms).
#[derive(Resource)]
pub struct Clock(Instant, pub Vec<f64>);

fn start(mut clock: ResMut<Clock>) {
    clock.0 = Instant::now();
}

fn stop(mut clock: ResMut<Clock>) {
    let passed = clock.0.elapsed().as_secs_f64();
    clock.1.push(1.0e3 * passed);
}

/// Pairs of triangles of all cloths that intersect, by brute force in f64.
pub fn crossed(world: &mut World) -> usize {
    let mut cloths = world.query::<(&ClothBuilt, &ClothParticles, &ClothFrame)>();
    let placed: Vec<(_, Vec<Vec3>)> = cloths
        .iter(world)
        .map(|(built, particles, frame)| {
            let places = particles.positions().map(|place| frame.to_world(place));
            (built.surface().clone(), places.collect())
        })
        .collect();
    let cloths: Vec<_> = placed
        .iter()
        .map(|(surface, places)| (&**surface, places.clone()))
        .collect();
    intersections(&cloths)
}
