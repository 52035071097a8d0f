//! The plugin, in an app as a game has it but for all that draws.

use std::time::Duration;

use bevy::{
    app::{TaskPoolOptions, TaskPoolPlugin},
    ecs::schedule::SingleThreadedExecutor,
    prelude::*,
    time::TimeUpdateStrategy,
};
use bevy_drape::{prelude::*, solver::ClothSettings};

use crate::{
    outcome::Places,
    player::Frames,
    scene::{FRAME, Hung, SIDE, Scene, WIDTH},
};

pub struct Ours(App);

impl Ours {
    /// With so many sub-steps a frame.
    pub fn new(scene: &Scene, substeps: u32, narrow_phase: NarrowPhase, start: u32) -> Self {
        let mut app = app();
        let pins = match scene.hung {
            Hung::TwoCorners => Pins::new([Corner::TopLeft, Corner::TopRight].map(Pin::Corner)),
            Hung::TopRow => Pins::top_row(),
            Hung::Nowhere => Pins::none(),
        };
        let settings = ClothSettings {
            // No solver is told to keep a distance between cloth and ball.
            particle_radius: 0.0,
            sleeps: false,
            ..ClothSettings::substeps(substeps)
        };
        let cloth = Cloth::new(SIDE, SIDE, WIDTH / (SIDE - 1) as f32);
        let world = app.world_mut();
        let cloth = world
            .spawn((cloth, pins, settings, scene.material(), narrow_phase))
            .id();
        if let Some(radius) = scene.ball {
            world.spawn((ClothCollider::ball(radius), Transform::default()));
        }
        // The first update of an app has no time in it; the second makes the particles, at rest until there is gravity.
        app.update();
        app.insert_resource(ClothGravity(Vec3::ZERO));
        app.update();
        app.insert_resource(ClothGravity::default());
        let mut cloth = app.world_mut().entity_mut(cloth);
        let mut particles = cloth
            .get_mut::<ClothParticles>()
            .expect("the plugin makes them");
        for row in 0..SIDE {
            for column in 0..SIDE {
                let place = scene.place(row, column, start);
                particles
                    .set_position((row, column), place)
                    .expect("it exists");
            }
        }
        Self(app)
    }
}

impl Frames for Ours {
    fn step(&mut self) {
        self.0.update();
    }

    fn places(&mut self) -> Places {
        let world = self.0.world_mut();
        let mut cloths = world.query::<&ClothParticles>();
        let particles = cloths.single(world).expect("there is one cloth");
        particles
            .positions()
            .map(|place| place.to_array())
            .collect()
    }
}

/// On one thread; each update is a fixed tick.
fn app() -> App {
    let mut app = App::new();
    let one_thread = TaskPoolPlugin {
        task_pool_options: TaskPoolOptions::with_num_threads(1),
    };
    app.add_plugins((
        MinimalPlugins.set(one_thread),
        TransformPlugin,
        DrapePlugins::default(),
    ))
    .insert_resource(Time::<Fixed>::from_duration(Duration::from_secs_f32(FRAME)))
    .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
    .edit_schedule(FixedUpdate, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
    app.finish();
    app.cleanup();
    app
}
