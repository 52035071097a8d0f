//! The search without a tree, in f64: the reference for every query.

use super::probe::Probe;
use crate::cloth::ClothParticles;

/// Returns the indices of all particles that `probe` meets, tested one by one in f64.
pub fn brute_force(particles: &ClothParticles, probe: &Probe) -> Vec<u32> {
    let places = particles.positions().enumerate();
    let met = places.filter(|(_, place)| probe.meets(*place));
    met.map(|(index, _)| index as u32).collect()
}
