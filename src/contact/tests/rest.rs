//! What is at rest stays at rest: friction that holds, cloth between two colliders.

use std::sync::Arc;

use bevy::math::{Isometry3d, Quat, Vec3};

use super::{all_of, at};
use crate::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::{ColliderShape, MovingCollider},
    },
    solver::{Solver, TickStep},
};

const BOTH: [NarrowPhase; 2] = [NarrowPhase::Particles, NarrowPhase::Triangles];
const SPACING: f32 = 0.05;

struct Scene {
    surface: Arc<Surface>,
    particles: ClothParticles,
    solver: Solver,
    settings: ContactSettings,
    step: TickStep,
    colliders: Vec<MovingCollider>,
}

impl Scene {
    fn new(columns: u32, rows: u32, substeps: u32, narrow_phase: NarrowPhase) -> Self {
        let material = ClothMaterial::COTTON;
        let surface = Cloth::new(columns, rows, SPACING)
            .surface(Vec3::ONE)
            .expect("a valid grid");
        let springs = Springs::of_surface(&surface, &material);
        Self {
            particles: ClothParticles::at_rest(&surface, &material).expect("a valid material"),
            solver: Solver::of_surface(&surface, &springs),
            surface: Arc::new(surface),
            settings: ContactSettings {
                particle_radius: 0.01,
                friction: 0.5,
                narrow_phase,
                ..ContactSettings::default()
            },
            step: TickStep {
                substeps,
                acceleration: Vec3::NEG_Z * 9.81,
                damping: material.damping,
                ..TickStep::default()
            },
            colliders: Vec::new(),
        }
    }

    /// Some ticks; returns the largest speed at the end of one (m/s).
    fn ticks(&mut self, count: u32) -> f32 {
        let mut fastest = 0.0_f32;
        for _ in 0..count {
            let Self {
                surface,
                particles,
                solver,
                settings,
                step,
                colliders,
            } = self;
            let mut detection = all_of(colliders, settings, surface, particles);
            solver.advance(particles, *step, &[], |particles, substep| {
                detection.respond(particles, settings, substep, |_| {})
            });
            for collider in colliders {
                let displacement = collider.to - Vec3::from(collider.from.translation);
                collider.from.translation = collider.to.into();
                collider.to += displacement;
            }
            fastest = fastest.max(particles.largest_speed());
        }
        fastest
    }
}

/// A strip hangs over a capsule of 1.5 spacings of radius, with 6 spacings more on one side: of 40, friction of 0.5 holds a ratio of
/// e^{0.5 π} = 4.8. It may settle for two seconds, and its end moves by less than a millimetre in the two that follow: by particles, it moves by half of one.
#[test]
fn friction_holds_a_strip_without_creep() {
    for narrow_phase in BOTH {
        for substeps in [20, 80] {
            let (columns, rows) = (41_u32, 5_u32);
            let mut scene = Scene::new(columns, rows, substeps, narrow_phase);
            scene.step.damping = 0.05;
            let radius = 1.5 * SPACING;
            let lies = radius + 0.011;
            let arc = std::f32::consts::PI * lies;
            for row in 0..rows {
                for column in 0..columns {
                    let along = SPACING * (column as f32 - 0.5 * (columns - 1) as f32 + 3.0);
                    let over = (along.abs() - arc / 2.0).max(0.0);
                    let angle = along.signum() * (along.abs() - over) / lies;
                    let place = Vec3::new(
                        lies * angle.sin(),
                        -SPACING * row as f32,
                        lies * angle.cos() - over,
                    );
                    scene
                        .particles
                        .set_position((row, column), place)
                        .expect("it exists");
                }
            }
            let shape = ColliderShape::Capsule {
                radius,
                half_length: 1.0,
            };
            let rod = MovingCollider::still(shape, at(Vec3::NEG_Y * 0.1));
            scene.colliders.push(rod);
            scene.ticks(128);
            let end = |scene: &Scene| {
                scene
                    .particles
                    .position((2, columns - 1))
                    .expect("it exists")
            };
            let before = end(&scene);
            scene.ticks(128);
            let crept = before.distance(end(&scene));
            println!("{narrow_phase:?}, {substeps} sub-steps: {crept} m");
            assert!(crept < 1.0e-3, "{narrow_phase:?} {substeps}: {crept} m");
        }
    }
}

/// A ball presses cloth against a floor and leaves it less room than its particles' radii: neither can have its way, and the cloth lies
/// still but for what a twentieth of the speed comes to that an overlap is let out at.
#[test]
fn cloth_that_is_trodden_on_lies_still() {
    for narrow_phase in BOTH {
        let mut scene = Scene::new(32, 32, 20, narrow_phase);
        let facing = Quat::from_rotation_arc(Vec3::Y, Vec3::Z);
        let floor = Isometry3d::new(Vec3::new(0.8, -0.8, -0.01), facing);
        scene
            .colliders
            .push(MovingCollider::still(ColliderShape::HalfSpace, floor));
        scene.ticks(32);
        let start = Vec3::new(0.81, -0.79, 0.25);
        let ball = MovingCollider::ball(0.2, start, start + Vec3::NEG_Z * 0.055 / 32.0);
        scene.colliders.push(ball);
        scene.ticks(32);
        scene.colliders[1].to = scene.colliders[1].from.translation.into();
        scene.ticks(64);
        let fastest = scene.ticks(64);
        println!("{narrow_phase:?}: {fastest} m/s");
        assert!(fastest < 0.15, "{narrow_phase:?}: {fastest} m/s");
    }
}
