//! The search without a tree, in f64: the reference for every query.

use super::probe::Probe;
use crate::cloth::ClothParticles;

/// Returns the indices of all particles that `probe` meets, tested one by one in f64.
pub fn brute_force(particles: &ClothParticles, probe: &Probe) -> Vec<u32> {
    let meets = |index: &u32| probe.meets(particles.position_at(*index as usize));
    (0..particles.len() as u32).filter(meets).collect()
}
