//! The plugin, in an app as a game has it but for all that draws.

use std::time::Duration;

use bevy::{
    app::{TaskPoolOptions, TaskPoolPlugin},
    ecs::schedule::SingleThreadedExecutor,
    prelude::*,
    time::TimeUpdateStrategy,
};
use bevy_drape::{
    prelude::*,
    solver::{ClothPressure, ClothSettings, Substepping},
};

use crate::{
    collider::{Collider, Shape},
    outcome::Places,
    player::Frames,
    told::{FRAME, Garment, Told, order},
};

/// The pressure around a gas (Pa), which the plugin always has. Others have none.
const OUTSIDE: f32 = 0.1;

pub struct Ours {
    app: App,
    moving: Vec<(Entity, Collider)>,
    /// The particle of each vertex.
    order: Vec<usize>,
    frame: u32,
}

impl Ours {
    pub fn new(
        garment: &Garment,
        told: &Told,
        substepping: Substepping,
        narrow_phase: NarrowPhase,
    ) -> Self {
        let mut app = app();
        let settings = ClothSettings {
            substepping,
            particle_radius: told.margin,
            sleeps: false,
            ..ClothSettings::default()
        };
        let cloth = (garment.cloth.clone(), garment.pins.clone());
        let world = app.world_mut();
        let cloth = world
            .spawn((cloth, settings, garment.material, narrow_phase))
            .id();
        let mut moving = Vec::new();
        for collider in &told.colliders {
            let place = Transform::from_isometry((collider.at)(0.0));
            let entity = world.spawn((shape(collider.shape), place)).id();
            if collider.moves {
                moving.push((entity, *collider));
            }
        }
        // The first update of an app has no time in it; the second makes the particles, at rest until there is gravity.
        app.update();
        app.insert_resource(ClothGravity(Vec3::ZERO));
        app.update();
        app.insert_resource(ClothGravity::default());
        let mut cloth = app.world_mut().entity_mut(cloth);
        if told.gas > 0.0 {
            cloth.insert(ClothPressure::Gas {
                volume: told.gas / OUTSIDE,
                outside: OUTSIDE,
            });
        }
        let order = order(&garment.surface());
        let mut particles = cloth
            .get_mut::<ClothParticles>()
            .expect("the plugin makes them");
        for (&particle, place) in order.iter().zip(&told.positions) {
            particles
                .set_position(particle, Vec3::from_array(*place))
                .expect("it exists");
        }
        Self {
            app,
            moving,
            order,
            frame: 0,
        }
    }
}

impl Frames for Ours {
    fn step(&mut self) -> Result<(), String> {
        self.frame += 1;
        for (entity, collider) in &self.moving {
            let place = (collider.at)(self.frame as f32 * FRAME);
            let mut entity = self.app.world_mut().entity_mut(*entity);
            entity.insert(Transform::from_isometry(place));
        }
        self.app.update();
        Ok(())
    }

    fn places(&mut self) -> Places {
        let world = self.app.world_mut();
        let mut cloths = world.query::<&ClothParticles>();
        let particles = cloths.single(world).expect("there is one cloth");
        let place = |particle: &usize| particles.position(*particle).expect("it exists");
        let places = self.order.iter().map(place);
        places.map(|place| place.to_array()).collect()
    }
}

fn shape(shape: Shape) -> ClothCollider {
    match shape {
        Shape::Ball(radius) => ClothCollider::ball(radius),
        Shape::Capsule { radius, length } => ClothCollider::capsule(radius, length),
        Shape::Cuboid(sides) => ClothCollider::cuboid(sides.x, sides.y, sides.z),
        Shape::Floor => ClothCollider::plane(),
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
