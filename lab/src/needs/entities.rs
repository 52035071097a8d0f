//! Columns of particles, or an entity for each of them.
//!
//! The second is what a first draft in an ECS looks like: position, displacement and inverse mass are components, a spring
//! is a pair of entities, and a sub-step moves the particles and then looks up both ends of each spring. Same method,
//! same springs in the same order, in a schedule of its own. The solver's columns are swept many springs at once, which
//! is not a matter of storage alone: so the same loop, one spring after the other, goes over columns as well.

use bevy::{ecs::schedule::SingleThreadedExecutor, prelude::*};
use bevy_drape::{cloth::ClothParticles, solver::TickStep};

use super::{DISTANCE, Row};
use crate::{
    experiment::Run,
    measure::seconds,
    methods::{MassSpring, Method, Scene, Stepper, one_sweep},
};

pub const SCENE: &str = "columns or entities, 32²";
pub const COLUMNS: &str = "columns, vectorised";
pub const SCALAR: &str = "columns, scalar";
pub const ENTITIES: &str = "entities";

const SUBSTEPS: u32 = 20;

#[derive(Component)]
struct Position(Vec3);

#[derive(Component)]
struct Displacement(Vec3);

#[derive(Component)]
struct InverseMass(f32);

struct Link {
    ends: [Entity; 2],
    rest_length: f32,
    compliance: f32,
}

#[derive(Resource)]
struct Links(Vec<Link>);

#[derive(Resource)]
struct Step(TickStep);

/// A cloth of entities.
struct Entities {
    world: World,
    schedule: Schedule,
    particles: Vec<Entity>,
}

impl Entities {
    fn new(scene: &Scene) -> Self {
        let mut world = World::new();
        let masses = scene.particles.inverse_masses();
        let particles: Vec<Entity> = scene
            .particles
            .positions()
            .zip(masses)
            .map(|(position, inverse_mass)| {
                let particle = (
                    Position(position),
                    Displacement(Vec3::ZERO),
                    InverseMass(inverse_mass),
                );
                world.spawn(particle).id()
            })
            .collect();
        let links = scene.springs.to_vec().into_iter().map(|spring| Link {
            ends: spring.ends.map(|end| particles[end as usize]),
            rest_length: spring.rest_length,
            compliance: spring.compliance,
        });
        world.insert_resource(Links(links.collect()));
        world.insert_resource(Step(scene.step(SUBSTEPS)));
        let mut schedule = Schedule::default();
        schedule.set_executor(SingleThreadedExecutor::new());
        schedule.add_systems(tick);
        Self {
            world,
            schedule,
            particles,
        }
    }

    fn tick(&mut self) {
        self.schedule.run(&mut self.world);
    }

    fn positions(&self) -> impl Iterator<Item = Vec3> {
        let positions = self.particles.iter();
        positions.map(|&entity| {
            self.world
                .get::<Position>(entity)
                .map_or(Vec3::NAN, |position| position.0)
        })
    }
}

/// Root mean square of the distances to the same particles elsewhere (m).
fn distance(positions: impl Iterator<Item = Vec3>, others: &ClothParticles) -> f64 {
    let squares = positions.zip(others.positions());
    let sum: f64 = squares
        .map(|(here, other)| here.as_dvec3().distance_squared(other.as_dvec3()))
        .sum();
    (sum / others.len() as f64).sqrt()
}

fn tick(
    step: Res<Step>,
    links: Res<Links>,
    mut particles: Query<(&mut Position, &mut Displacement, &InverseMass)>,
) {
    let dt = step.0.seconds / step.0.substeps as f32;
    let fall = step.0.acceleration * dt * dt;
    let kept = (1.0 - step.0.damping).powf(60.0 * dt);
    for _ in 0..step.0.substeps {
        for (mut position, mut displacement, inverse_mass) in &mut particles {
            if inverse_mass.0 > 0.0 {
                displacement.0 = displacement.0 * kept + fall;
                position.0 += displacement.0;
            }
        }
        for link in &links.0 {
            let Ok([(mut a, mut move_a, w_a), (mut b, mut move_b, w_b)]) =
                particles.get_many_mut(link.ends)
            else {
                continue;
            };
            let span = b.0 - a.0;
            let length = span.length();
            let weight = w_a.0 + w_b.0 + link.compliance / (dt * dt);
            if length > 0.0 && weight > 0.0 {
                let push = span * ((length - link.rest_length) / (length * weight));
                a.0 += push * w_a.0;
                move_a.0 += push * w_a.0;
                b.0 -= push * w_b.0;
                move_b.0 -= push * w_b.0;
            }
        }
    }
}

pub fn measure(run: &mut Run) -> Vec<Row> {
    let turns = run.either(1, 11);
    run.set("columns or entities", format!("32², 2 m wide, hung by its top row, let go at 0.5 rad, threads of 0.001 m/N; 20 sub-steps of 1/60 s on one thread, {turns} times a second; the scalar loop over columns and that over entities sweep the springs one by one, in the solver's order"));
    let scene = Scene::swinging(32, 2.0, 0.5, 1.0e-3).expect("a valid scene");
    let step = scene.step(SUBSTEPS);
    let method = Method::SmallSteps { substeps: SUBSTEPS };
    let mut ms = [const { Vec::new() }; 3];
    let mut distances = [0.0; 2];
    for _ in 0..turns {
        let mut solver = one_sweep(&scene);
        let mut particles = scene.particles.clone();
        let mut scalar = MassSpring::<f32>::of_scene(&scene).expect("a valid scene");
        let mut stepper =
            Stepper::new(method, &scalar, f64::from(step.seconds)).expect("a valid step");
        let mut entities = Entities::new(&scene);
        for _ in 0..60 {
            let times = [
                seconds(|| {
                    solver.advance(&mut particles, step, &[], |_, _| false);
                }),
                seconds(|| stepper.step(&mut scalar, step.acceleration.to_array(), step.damping)),
                seconds(|| entities.tick()),
            ];
            for (ms, seconds) in ms.iter_mut().zip(times) {
                ms.push(1.0e3 * seconds);
            }
        }
        let scalar = scalar.positions.iter().copied().map(Vec3::from_array);
        distances = [
            distance(scalar, &particles),
            distance(entities.positions(), &particles),
        ];
    }
    let errors = [0.0, distances[0], distances[1]];
    let choices = [COLUMNS, SCALAR, ENTITIES]
        .into_iter()
        .zip(ms.iter().zip(errors));
    choices
        .map(|(choice, (ms, error))| Row::new(SCENE, choice, ms, (error, DISTANCE)))
        .collect()
}
