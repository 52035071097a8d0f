//! A ball shot at a free cloth: whether it gets through. The lab uses this, too.

use std::sync::Arc;

use bevy::math::{DVec3, Vec3, bounding::BoundingSphere};

use super::library::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    contact::{ContactSettings, Detection, MovingCollider},
    solver::{Solver, TickStep},
};

const SIDE: u32 = 16;
/// Distance between particles (m).
pub const SPACING: f32 = 0.1;
/// Sub-steps a second: 20 in each of 60 ticks.
pub const SUBSTEPS_A_SECOND: f32 = 1200.0;
const SUBSTEPS: u32 = 20;

/// A shot at the middle third of a free cloth of 16 × 16 particles.
#[derive(Debug, Clone, Copy)]
pub struct Shot {
    /// m/s
    pub speed: f32,
    /// Of the ball (m).
    pub radius: f32,
    /// Whether the ball is tested all along its way, or at the ends of sub-steps alone.
    pub is_swept: bool,
    /// Where it meets the cloth, from −1 to 1 across the middle third and down it.
    pub beside: [f32; 2],
    /// When in the first tick it meets the cloth, from 0 to 1.
    pub delay: f32,
    /// Its way, of length 1: along z it meets the cloth head on.
    pub direction: Vec3,
    /// How it spins (rad/s).
    pub spin: Vec3,
}

impl Shot {
    /// After how many ticks the ball is through: its centre has passed a triangle. `None` if it is not 12 ticks after
    /// it has hit the cloth.
    ///
    /// That the cloth is still before it would say less: it may be thrown ahead, or slip off sideways.
    pub fn through(&self) -> Option<u32> {
        let material = ClothMaterial::COTTON;
        let grid = Cloth::new(SIDE, SIDE, SPACING)
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let surface = Arc::new(Surface::of_grid(&grid));
        let particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
        let springs = Springs::of_grid(&grid, &material);
        self.through_cloth(&surface, &springs, particles, 13)
    }

    /// The same of any cloth as large as that one and in its place, within so many ticks.
    pub fn through_cloth(
        &self,
        surface: &Arc<Surface>,
        springs: &Springs,
        mut particles: ClothParticles,
        ticks: u32,
    ) -> Option<u32> {
        let mut solver = Solver::new(springs, &particles);
        let step = TickStep {
            seconds: SUBSTEPS as f32 / SUBSTEPS_A_SECOND,
            substeps: SUBSTEPS,
            acceleration: Vec3::NEG_Y * 9.81,
            damping: 0.01,
            ..TickStep::default()
        };
        let settings = ContactSettings {
            particle_radius: 0.01,
            friction: 0.3,
            is_swept: self.is_swept,
            ..ContactSettings::default()
        };
        let width = (SIDE - 1) as f32 * SPACING;
        let [across, down] = self.beside;
        let beside = Vec3::new(across, down, 0.0) * (width / 6.0);
        let behind =
            (self.radius + 0.01) / self.direction.z + self.delay * self.speed * step.seconds;
        let mut centre =
            Vec3::new(width / 2.0, -width / 2.0, 0.0) + beside - self.direction * behind;
        for tick in 0..ticks {
            let to = centre + self.direction * self.speed * step.seconds;
            let ball = MovingCollider {
                turn: self.spin * step.seconds,
                ..MovingCollider::ball(self.radius, centre, to)
            };
            let mut detection = of_all(&ball, &settings, surface, &particles);
            let mut before = seen(&particles, surface, centre);
            let mut is_through = false;
            solver.advance(&mut particles, step, &[], |particles, substep| {
                let is_pushed = detection.respond(particles, &settings, substep, |_| {});
                let at = Vec3::from(ball.pose_at(substep.end()).translation);
                let after = seen(particles, surface, at);
                is_through |= before.iter().zip(&after).any(|(a, b)| crosses(*a, *b));
                before = after;
                is_pushed
            });
            assert_eq!(particles.validate(), Ok(()));
            centre = to;
            // Until it is through, it has the cloth in front of it, or beside it, where that has slipped off.
            if is_through {
                return Some(tick);
            }
        }
        None
    }
}

/// A tick in which every particle is a candidate: nothing can be missed.
fn of_all(
    ball: &MovingCollider,
    settings: &ContactSettings,
    surface: &Arc<Surface>,
    particles: &ClothParticles,
) -> Detection {
    let mut detection = Detection::default();
    detection.begin(surface, f32::INFINITY);
    let all: Vec<u32> = (0..particles.len() as u32).collect();
    let cloth = BoundingSphere::new(Vec3::ZERO, 100.0);
    let (_, narrow_phase) = detection.probe(ball, settings, surface, 0.0, &cloth);
    detection.add(0, ball, narrow_phase, &all, particles);
    detection
}

/// Corners of all triangles, seen from a ball's centre (m).
fn seen(particles: &ClothParticles, surface: &Surface, centre: Vec3) -> Vec<[DVec3; 3]> {
    let place = |index: u32| particles.position(index as usize).expect("it exists");
    let offset = |index: u32| place(index).as_dvec3() - centre.as_dvec3();
    surface
        .triangles()
        .iter()
        .map(|corners| corners.map(offset))
        .collect()
}

/// Whether a triangle passes over the origin between two states, along straight lines: where its plane does, the
/// origin is in it. The plane's passing is looked for in 16 parts.
fn crosses(before: [DVec3; 3], after: [DVec3; 3]) -> bool {
    // Most are all on one side.
    let (low, high) = before
        .into_iter()
        .chain(after)
        .fold((DVec3::MAX, DVec3::MIN), |(low, high), p| {
            (low.min(p), high.max(p))
        });
    if low.max_element() > 0.0 || high.min_element() < 0.0 {
        return false;
    }
    let when = |part: f64| [0, 1, 2].map(|corner| before[corner].lerp(after[corner], part));
    let height = |part: f64| {
        let [a, b, c] = when(part);
        a.dot(b.cross(c))
    };
    (0..16).any(|index| {
        let [mut from, mut to] = [index, index + 1].map(|index| f64::from(index) / 16.0);
        if height(from) * height(to) > 0.0 {
            return false;
        }
        for _ in 0..40 {
            let middle = f64::midpoint(from, to);
            if height(from) * height(middle) > 0.0 {
                from = middle;
            } else {
                to = middle;
            }
        }
        let [a, b, c] = when(to);
        let normal = (b - a).cross(c - a);
        [(a, b), (b, c), (c, a)]
            .into_iter()
            .all(|(p, q)| p.cross(q).dot(normal) >= 0.0)
    })
}
