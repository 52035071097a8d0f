//! A ball pressed into a cloth that is held by its rim.

use std::{sync::Arc, time::Instant};

use bevy::math::{Vec3, bounding::BoundingSphere};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    contact::{ContactSettings, Detection, MovingCollider, NarrowPhase},
    hierarchy::TopDownQuery,
    solver::{Solver, TickStep},
};

const SIDE: u32 = 33;
/// Distance between particles (m).
pub const SPACING: f32 = 0.05;
const TICKS: u32 = 128;

pub struct Pressed {
    /// How deep the deepest point of a triangle is inside of the ball (m).
    pub deepest: f32,
    /// Of each tick's response, all of its sub-steps together (s).
    pub responses: Vec<f64>,
    /// Particles or cells that the last tick's response tested.
    pub candidates: usize,
}

/// By a ball of a radius (m), six spacings deep, tested against particles or triangles.
pub fn press(radius: f32, narrow_phase: NarrowPhase) -> Pressed {
    let grid = Cloth::new(SIDE, SIDE, SPACING)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let material = ClothMaterial {
        stretch_compliance: 5.0e-3,
        shear_compliance: 1.0e-2,
        damping: 0.05,
        ..ClothMaterial::COTTON
    };
    let surface = Arc::new(Surface::of_grid(&grid));
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
    let rim =
        |row: u32, column: u32| row.is_multiple_of(SIDE - 1) || column.is_multiple_of(SIDE - 1);
    let pinned: Vec<(u32, u32)> = grid
        .cells()
        .filter(|&(row, column)| rim(row, column))
        .collect();
    for cell in pinned {
        particles.set_inverse_mass(cell, 0.0).expect("it exists");
    }
    let mut solver = Solver::new(&Springs::of_grid(&grid, &material), &particles);
    let settings = ContactSettings {
        particle_radius: 0.0,
        friction: 0.3,
        narrow_phase,
        ..Default::default()
    };
    let mut detection = Detection::default();
    let mut query = TopDownQuery::default();
    // Over the middle of a cell, and not quite: nothing in the field is symmetric.
    let at = |height: f32| Vec3::new(16.48 * SPACING, -16.53 * SPACING, height);
    let height = |tick: u32| {
        radius + 0.01
            - (radius + 0.01 + 6.0 * SPACING) * (tick as f32 / (0.75 * TICKS as f32)).min(1.0)
    };
    let (mut responses, mut candidates) = (Vec::new(), 0);
    for tick in 0..TICKS {
        let ball = MovingCollider::ball(radius, at(height(tick)), at(height(tick + 1)));
        detection.begin(&surface, 0.1);
        let cloth = BoundingSphere::new(at(0.0), 2.0);
        let (probe, against) = detection.probe(&ball, &settings, &surface, 4.0 * SPACING, &cloth);
        query.clear();
        query.scan(&particles, &probe);
        detection.add(0, &ball, against, query.candidates(), &particles);
        candidates = query.candidates().len();
        let step = TickStep {
            acceleration: Vec3::NEG_Z * 9.81,
            damping: material.damping,
            ..Default::default()
        };
        let mut spent = 0.0;
        solver.advance(&mut particles, step, &[], |particles, substep| {
            let start = Instant::now();
            let moved = detection.respond(particles, &settings, substep, |_| {});
            spent += start.elapsed().as_secs_f64();
            moved
        });
        responses.push(spent);
    }
    let centre = at(height(TICKS));
    Pressed {
        deepest: deepest_triangle(&particles, &surface, centre, radius),
        responses,
        candidates,
    }
}

/// Over a fine net of points of every triangle. A cloth above the ball's centre has let it through.
fn deepest_triangle(
    particles: &ClothParticles,
    surface: &Surface,
    centre: Vec3,
    radius: f32,
) -> f32 {
    const PARTS: u32 = 24;
    let mut deepest = f32::MIN;
    for triangle in surface.triangles() {
        let [a, b, c] =
            triangle.map(|index| particles.position(index as usize).expect("it exists"));
        if a.distance(centre) > radius + 3.0 * SPACING {
            continue;
        }
        for u in 0..=PARTS {
            for v in 0..=PARTS - u {
                let [u, v] = [u, v].map(|part| part as f32 / PARTS as f32);
                let point = a + (b - a) * u + (c - a) * v;
                deepest = deepest.max(radius - point.distance(centre));
            }
        }
    }
    // Pressed down, the cloth has to be below: a ball that nothing touches fell through.
    if deepest < -0.5 * SPACING {
        radius
    } else {
        deepest
    }
}
