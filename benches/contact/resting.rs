//! A cloth that lies on a fixed ball, and the same cloth without it: what contact costs.

use std::{sync::Arc, time::Instant};

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, SpringKind, Springs, Surface},
    contact::{ContactSettings, Detection, MovingCollider, NarrowPhase},
    hierarchy::{BoundRule, BoundingVolume, NodeBounds, QuadTree, TopDownQuery},
    solver::{Bending, Solver, TickStep},
};

/// Particles along each side, and how wide the cloth is (m).
const SIDE: u32 = 64;
const WIDTH: f32 = 2.0;
/// Of the ball (m).
const RADIUS: f32 = 0.5;
/// How long it may come to rest, and is measured then, in ticks.
const SETTLING: u32 = 192;
const MEASURED: u32 = 64;

/// What a tick takes.
pub struct Cost {
    /// The shortest tick, search and all (s).
    pub tick: f64,
    /// All responses of a tick, in the mean (s).
    pub response: f64,
    /// How deep a point of a triangle is inside of the ball in the last second (m).
    pub deepest: f32,
}

/// A cloth of cotton that lies on a ball, tested against particles or triangles; held by its corners, without one.
pub fn rest(narrow_phase: Option<NarrowPhase>) -> Cost {
    let material = ClothMaterial::COTTON;
    let surface = Cloth::new(SIDE, SIDE, WIDTH / (SIDE - 1) as f32)
        .surface(Vec3::ONE)
        .expect("a valid grid");
    let surface = Arc::new(surface);
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
    let springs = Springs::of_surface(&surface, &material);
    let mut solver = Solver::of_surface(&surface, &springs);
    solver.set_bending(Bending::new(&surface, &material));
    let tree = QuadTree::of_surface(&surface, springs.has(SpringKind::Shear));
    let mut bounds = NodeBounds::default();
    let mut query = TopDownQuery::default();
    let mut detection = Detection::default();
    let settings = ContactSettings {
        particle_radius: 0.01,
        friction: 0.4,
        narrow_phase: narrow_phase.unwrap_or_default(),
        ..Default::default()
    };
    let step = TickStep {
        acceleration: Vec3::NEG_Z * 9.81,
        damping: material.damping,
        ..Default::default()
    };
    let centre = Vec3::new(WIDTH / 2.0, -WIDTH / 2.0, -RADIUS - 0.02);
    let ball = MovingCollider::ball(RADIUS, centre, centre);
    if narrow_phase.is_none() {
        let ends = [0, SIDE - 1];
        for corner in ends
            .map(|row| ends.map(|column| (row, column)))
            .as_flattened()
        {
            particles.set_inverse_mass(*corner, 0.0).expect("it exists");
        }
    }
    let mut stretch = solver.measure(&particles);
    let mut cost = Cost {
        tick: f64::INFINITY,
        response: 0.0,
        deepest: 0.0,
    };
    for tick in 0..SETTLING + MEASURED {
        let start = Instant::now();
        let by_itself = (particles.largest_speed() + 9.81 * step.seconds) * step.seconds;
        detection.begin(&surface, by_itself + 0.01);
        if narrow_phase.is_some() {
            bounds
                .rebuild(
                    (BoundingVolume::Sphere, BoundRule::RestShape),
                    &tree,
                    &particles,
                    stretch.bound,
                )
                .expect("there is such a rule");
            let root = tree.root_sphere(&particles, stretch.bound);
            let longest = 2.0 * surface.spacing().longest;
            let (probe, against) = detection.probe(&ball, &settings, &surface, longest, &root);
            query.clear();
            query.search(&tree, &bounds, &particles, &probe);
            detection.add(0, &ball, against, query.candidates(), &particles);
        }
        let mut response = 0.0;
        stretch = solver.advance(&mut particles, step, &[], |particles, substep| {
            let start = Instant::now();
            let is_pushed = detection.respond(particles, &settings, substep, |_| {});
            response += start.elapsed().as_secs_f64();
            is_pushed
        });
        if tick >= SETTLING {
            cost.tick = cost.tick.min(start.elapsed().as_secs_f64());
            cost.response += response / f64::from(MEASURED);
            if narrow_phase.is_some() {
                cost.deepest = cost.deepest.max(deepest(&particles, &surface, centre));
            }
        }
    }
    cost
}

/// Of a net of points of every triangle (m).
fn deepest(particles: &ClothParticles, surface: &Surface, centre: Vec3) -> f32 {
    const PARTS: u32 = 6;
    let mut deepest = 0.0_f32;
    for triangle in surface.triangles() {
        let [a, b, c] =
            triangle.map(|index| particles.position(index as usize).expect("it exists"));
        for u in 0..=PARTS {
            for v in 0..=PARTS - u {
                let [u, v] = [u, v].map(|part| part as f32 / PARTS as f32);
                let point = a + (b - a) * u + (c - a) * v;
                deepest = deepest.max(RADIUS - point.distance(centre));
            }
        }
    }
    deepest
}
