//! What the benchmarks share: scenes in motion, and the layout that they are held against.

#[path = "../../tests/shared/scene.rs"]
#[expect(dead_code, reason = "no benchmark lets a cloth swing")]
mod scene;

use bevy::math::Vec3;
use bevy_drape::cloth::SpringKind;
pub use scene::Scene;

/// Sub-steps in a timed tick.
pub const SUBSTEPS: u32 = 20;

/// The cloth hung by two corners, a quarter of a second into its fall: not flat, and no number tiny.
pub fn in_motion(side: u32) -> Scene {
    let mut scene = Scene::hung_by_corners(side, 2.0).expect("a valid scene");
    let mut solver = scene.solver(true);
    let mut particles = scene.particles.clone();
    for _ in 0..15 {
        solver.advance(&mut particles, scene.step(10), &[], |_, _| false);
    }
    scene.particles = particles;
    scene
}

/// Springs as a first draft has them: arrays of vectors, and a list of edges from each particle to the right, down and
/// along both diagonals, in the order of the particles.
pub struct Naive {
    position: Vec<Vec3>,
    displacement: Vec<Vec3>,
    inverse_mass: Vec<f32>,
    edges: Vec<(u32, u32, f32)>,
}

impl Naive {
    /// Of a scene; with its springs sorted by colour, if asked for.
    pub fn new(scene: &Scene, is_coloured: bool) -> Self {
        let mut edges: Vec<_> = scene
            .springs
            .to_vec()
            .into_iter()
            .filter(|spring| spring.kind != SpringKind::Bend)
            .map(|spring| (spring.ends[0], spring.ends[1], spring.rest_length))
            .collect();
        if !is_coloured {
            edges.sort_by_key(|&(a, b, _)| (a, b));
        }
        Self {
            position: scene.particles.positions().collect(),
            displacement: scene.particles.displacements().collect(),
            inverse_mass: scene.particles.inverse_masses().collect(),
            edges,
        }
    }

    /// A tick of the same method: Verlet and one sweep a sub-step.
    pub fn tick(&mut self, scene: &Scene, substeps: u32) {
        let dt = scene.seconds / substeps as f32;
        let fall = scene.acceleration * dt * dt;
        for _ in 0..substeps {
            let state = self.position.iter_mut().zip(&mut self.displacement);
            for ((position, displacement), &inverse_mass) in state.zip(&self.inverse_mass) {
                if inverse_mass > 0.0 {
                    *displacement += fall;
                    *position += *displacement;
                }
            }
            for &(a, b, rest_length) in &self.edges {
                let (a, b) = (a as usize, b as usize);
                let span = self.position[b] - self.position[a];
                let length = span.length();
                let (w_a, w_b) = (self.inverse_mass[a], self.inverse_mass[b]);
                if length > 0.0 && w_a + w_b > 0.0 {
                    let share = (length - rest_length) / (length * (w_a + w_b));
                    let (move_a, move_b) = (span * (share * w_a), span * (share * w_b));
                    self.position[a] += move_a;
                    self.displacement[a] += move_a;
                    self.position[b] -= move_b;
                    self.displacement[b] -= move_b;
                }
            }
        }
    }
}
