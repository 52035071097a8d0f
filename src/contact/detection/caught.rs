//! Cloth that is caught between two colliders.

use super::Detection;
use crate::{cloth::ClothParticles, contact::candidates::Touch};

/// Two colliders push against each other where the cosine of the angle between their normals is less: in a gap that opens by less
/// than 60°, and not in the corner of a room.
const AGAINST: f32 = -0.5;

impl Detection {
    /// The numbers of two colliders that pushed the same particle in the tick, against each other.
    pub(crate) fn caught_between(&self, particles: &ClothParticles) -> Option<[usize; 2]> {
        for (index, first) in self.touches.iter().enumerate() {
            for second in &self.touches[index + 1..] {
                let stands = |a: &Touch, b: &Touch| self.supports.is_held_by(a.id, b.id);
                if stands(first, second) || stands(second, first) {
                    continue;
                }
                let pushed_by_first = self.points(first).filter(|point| point.depth > 0.0);
                let others = &self.candidates.all[second.of.candidates.clone()];
                let is_caught = |particle: u32| {
                    let other = others.binary_search_by_key(&particle, |other| other.particle);
                    let is_pushed =
                        other.is_ok_and(|at| self.candidates.depth_of(&others[at]) > 0.0);
                    let place = particles.position_at(particle as usize);
                    let normal = |touch: &Touch| touch.collider.nearest(1.0, place).normal;
                    is_pushed && normal(first).dot(normal(second)) < AGAINST
                };
                if pushed_by_first.map(|point| point.particle).any(is_caught) {
                    return Some([first.id, second.id]);
                }
            }
        }
        None
    }
}
