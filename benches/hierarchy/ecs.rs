//! The systems that search, in an app.

use std::time::{Duration, Instant};

use bevy::{ecs::schedule::SingleThreadedExecutor, prelude::*, time::TimeUpdateStrategy};
use bevy_drape::prelude::*;

/// When the first of the two systems began, and what both took in each tick (s).
#[derive(Resource, Default)]
struct Times {
    begun: Option<Instant>,
    taken: Vec<f64>,
}

/// Rebuild and query of this many awake cloths, with one ball far away from all of them (ns a cloth).
pub fn nanoseconds_a_cloth(count: usize) -> f64 {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
            1.0 / 64.0,
        )))
        .init_resource::<Times>()
        .edit_schedule(FixedUpdate, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        })
        .add_systems(
            FixedUpdate,
            (
                begin
                    .after(ClothSystems::Prepare)
                    .before(ClothSystems::Rebuild),
                end.after(ClothSystems::Query)
                    .before(ClothSystems::Integrate),
            ),
        );
    for index in 0..count {
        let place = Transform::from_xyz(2.0 * index as f32, 0.0, 0.0);
        app.world_mut().spawn((Cloth::default(), place));
    }
    let far = Transform::from_xyz(0.0, 1.0e3, 0.0);
    app.world_mut().spawn((ClothCollider::ball(1.0), far));
    for _ in 0..40 {
        app.update();
    }
    let mut taken = app.world().resource::<Times>().taken.clone();
    1.0e9 * super::median(&mut taken) / count as f64
}

fn begin(mut times: ResMut<Times>) {
    times.begun = Some(Instant::now());
}

fn end(mut times: ResMut<Times>) {
    if let Some(begun) = times.begun.take() {
        times.taken.push(begun.elapsed().as_secs_f64());
    }
}
