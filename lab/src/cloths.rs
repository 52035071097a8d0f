//! The cloths that experiments share.

use std::sync::{Arc, LazyLock};

use bevy::math::{Vec3, bounding::BoundingSphere};
use bevy_drape::{
    cloth::{Cloth, ClothGrid, ClothMaterial, ClothParticles, Springs, Surface},
    contact::{ContactSettings, Detection, MovingCollider, NarrowPhase},
    hierarchy::{BoundRule, BoundingVolume, Probe, QuadTree, SearchMethod, TopDownQuery},
    solver::{Solver, Tethers, TickStep},
};

/// What a tree is searched by.
pub type Choice = (BoundingVolume, BoundRule);

/// Each volume by each rule that there is for it: the library's menu, so that nothing new is left out.
pub static CHOICES: LazyLock<Vec<Choice>> = LazyLock::new(|| {
    let trees = SearchMethod::ALL
        .into_iter()
        .filter_map(|method| match method {
            SearchMethod::Tree(volume, rule) => Some((volume, rule)),
            _ => None,
        });
    trees.collect()
});

/// The paper's scene, tick by tick: a cloth of 16 × 16 particles hangs by its top row, and a ball of radius 1 goes
/// through it and back.
pub struct Recording {
    pub tree: QuadTree,
    pub grid: ClothGrid,
    pub states: Vec<State>,
}

/// A tick's end.
pub struct State {
    pub particles: ClothParticles,
    /// The largest stretch: what `RestShape` needs.
    pub stretch: f32,
    pub ball: Probe,
}

/// Distance between particles (m).
const SPACING: f32 = 0.2;
const SIDE: u32 = 16;
const RADIUS: f32 = 1.0;
/// How far from the cloth the ball turns back (m), and its speed (m/s).
const TURNING: f32 = 2.8;
const SPEED: f32 = 1.5;

impl Recording {
    /// Of this many ticks, 64 a second. From the beginning of the ball's way there is a touch after some 80.
    pub fn new(ticks: u32) -> Self {
        let material = ClothMaterial::COTTON;
        let grid = Cloth::new(SIDE, SIDE, SPACING)
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let surface = Arc::new(Surface::of_grid(&grid));
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
        for column in 0..SIDE {
            particles
                .set_inverse_mass((0, column), 0.0)
                .expect("it exists");
        }
        let springs = Springs::of_grid(&grid, &material);
        let mut solver = Solver::new(&springs, &particles);
        solver.set_tethers(Tethers::new(&surface, &material, &particles, 9.81));
        let step = TickStep {
            acceleration: Vec3::NEG_Y * 9.81,
            damping: material.damping,
            ..Default::default()
        };
        let settings = ContactSettings {
            particle_radius: 0.02,
            friction: material.friction,
            narrow_phase: NarrowPhase::Particles,
            ..Default::default()
        };
        let width = SPACING * (SIDE - 1) as f32;
        let at = |tick: u32| {
            // There and back again.
            let way = SPEED * tick as f32 * step.seconds;
            let part = (way / TURNING).rem_euclid(4.0);
            let part = if part > 2.0 { 4.0 - part } else { part } - 1.0;
            Vec3::new(width / 2.0, -1.95, TURNING * part)
        };
        let mut detection = Detection::default();
        let mut query = TopDownQuery::default();
        let mut states = Vec::new();
        // More than it ever moves in a tick, and a ball around all that it ever does.
        let reach = 0.2;
        let cloth = BoundingSphere::new(Vec3::ZERO, 10.0);
        for tick in 0..ticks {
            let ball = MovingCollider::ball(RADIUS, at(tick), at(tick + 1));
            detection.begin(&surface, reach);
            let (probe, against) =
                detection.probe(&ball, &settings, &surface, 2.0 * SPACING, &cloth);
            query.clear();
            query.scan(&particles, &probe);
            detection.add(0, &ball, against, query.candidates(), &particles);
            let stretch = solver.advance(&mut particles, step, &[], |particles, substep| {
                detection.respond(particles, &settings, substep, |_| {})
            });
            states.push(State {
                particles: particles.clone(),
                stretch: stretch.bound,
                ball: Probe::ball(at(tick + 1), RADIUS, settings.particle_radius),
            });
        }
        Self {
            tree: QuadTree::of_grid(&grid, true),
            grid,
            states,
        }
    }
}
