//! A ball, moved by Avian, falls on a trampoline of cloth: what it takes to have both in one game.
//!
//! ```sh
//! cargo run     # the report
//! cargo test    # holds it
//! ```

mod adapter;
#[cfg(test)]
mod tests;

use std::time::Duration;

use avian3d::prelude::*;
use bevy::{prelude::*, time::TimeUpdateStrategy};
use bevy_drape::prelude::*;

use crate::adapter::{AvianClothCollider, AvianClothPlugin, AvianPushBack};

/// Radius (m) and mass (kg) of the ball.
const RADIUS: f32 = 0.15;
const MASS: f32 = 0.2;

/// Ticks in a second.
const TICKS: u32 = 64;

/// A game without a window, in which every update is a tick.
fn game() -> App {
    let mut app = App::new();
    let tick = Duration::from_secs_f64(1.0 / f64::from(TICKS));
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .add_plugins((
            PhysicsPlugins::default(),
            DrapePlugins::new(FixedPostUpdate),
            AvianClothPlugin,
        ))
        .insert_resource(Time::<Fixed>::from_hz(f64::from(TICKS)))
        .insert_resource(TimeUpdateStrategy::ManualDuration(tick));
    app.finish();
    app.cleanup();
    app
}

/// A cloth of 1.6 m × 1.6 m, held by its edges, level.
fn trampoline() -> impl Bundle {
    let last = 32;
    let at_edge = move |row, column| [0, last].contains(&row) || [0, last].contains(&column);
    (
        Name::new("trampoline"),
        Cloth::new(last + 1, last + 1, 0.05).lying().centred(),
        Pins::filter(at_edge),
        // It loses more of its motion than cotton does, so that the ball rests within seconds.
        ClothMaterial {
            damping: 0.05,
            ..ClothMaterial::COTTON
        },
    )
}

/// A ball of Avian's (m, kg) that cloth touches and pushes back.
fn ball(height: f32) -> impl Bundle {
    (
        Name::new("ball"),
        RigidBody::Dynamic,
        Collider::sphere(RADIUS),
        Mass(MASS),
        AvianClothCollider,
        AvianPushBack,
        Transform::from_xyz(0.0, height, 0.0),
    )
}

/// How high the ball is and how fast it rises (m, m/s), and how high the lowest point of the cloth is (m).
fn look(app: &App, ball: Entity, cloth: Entity) -> [f32; 3] {
    let world = app.world();
    let height = world
        .get::<Transform>(ball)
        .map_or(f32::NAN, |at| at.translation.y);
    let speed = world
        .get::<LinearVelocity>(ball)
        .map_or(f32::NAN, |velocity| velocity.y);
    let frame = world.get::<ClothFrame>(cloth).copied().unwrap_or_default();
    let lowest = world
        .get::<ClothParticles>(cloth)
        .map_or(f32::NAN, |particles| {
            let heights = particles.positions().map(|at| frame.to_world(at).y);
            // The first tick builds it, level.
            heights.reduce(f32::min).unwrap_or(0.0)
        });
    [height, speed, lowest]
}

fn main() {
    let mut app = game();
    let cloth = app.world_mut().spawn(trampoline()).id();
    let ball = app.world_mut().spawn(ball(1.0)).id();
    println!(
        "A ball of {MASS} kg and {RADIUS} m falls on a level cloth, held by its edges at height 0."
    );
    println!("time (s)  ball's lowest point (m)  its speed (m/s)  cloth's lowest point (m)");
    // The first update takes no time.
    app.update();
    let mut deepest = f32::INFINITY;
    for tick in 0..=10 * TICKS {
        let [height, speed, lowest] = look(&app, ball, cloth);
        deepest = deepest.min(height - RADIUS);
        if tick % (TICKS / 4) == 0 && (tick <= 3 * TICKS || tick % TICKS == 0) {
            let seconds = f64::from(tick) / f64::from(TICKS);
            println!(
                "{seconds:8.2}  {:23.3}  {speed:15.3}  {lowest:24.3}",
                height - RADIUS
            );
        }
        app.update();
    }
    println!("Its deepest: {deepest:.3} m.");
}
