//! The search without a tree: all particles, eight at a time, or one by one in f64.

use multiversion::multiversion;

use super::probe::Probe;
use crate::cloth::{Block, ClothParticles, LANES, Layout};

/// Appends the indices of all particles that `probe` meets.
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
pub(super) fn scan(blocks: &[Block], layout: Layout, probe: &Probe, found: &mut Vec<u32>) {
    let reach = probe.reach() as f32;
    for (index, block) in blocks.iter().enumerate() {
        if probe.core.may_reach_any(block.view(), reach) {
            meet(block, index, layout, probe, found);
        }
    }
}

/// Appends the particles of a block that the probe meets exactly.
#[cold]
#[inline(never)]
fn meet(block: &Block, index: usize, layout: Layout, probe: &Probe, found: &mut Vec<u32>) {
    for lane in 0..LANES {
        if let Some(particle) = layout.index_at(index, lane)
            && probe.meets(block.position(lane))
        {
            found.push(particle);
        }
    }
}

/// Returns the indices of all particles that `probe` meets, tested one by one in f64.
pub fn brute_force(particles: &ClothParticles, probe: &Probe) -> Vec<u32> {
    let places = particles.positions().enumerate();
    let met = places.filter(|(_, place)| probe.meets(*place));
    met.map(|(index, _)| index as u32).collect()
}
