//! Triangles pinned to a collider.

use crate::{cloth::ClothParticles, contact::colliders::MovingCollider};

/// Whether a triangle hangs from a pin inside a collider or within a particle's radius (m) of it at the beginning of
/// the tick, some sub-steps ago, or all of its corners are pinned. Such a triangle cannot be pushed out: the attempt
/// would push the hanging cloth in every sub-step.
#[inline]
pub(super) fn is_sewn_on(
    face: &[u32; 3],
    collider: &MovingCollider,
    (passed, particle_radius): (u32, f32),
    particles: &ClothParticles,
) -> bool {
    let is_pinned = |corner: &&u32| particles.is_pinned(**corner as usize) == Some(true);
    let is_near = |corner: &u32| {
        let index = *corner as usize;
        // A pin moves uniformly.
        let moved = particles.displacement(index).unwrap_or_default();
        let began = particles.position_at(index) - moved * passed as f32;
        collider.nearest(0.0, began).distance < particle_radius
    };
    let mut pinned = face.iter().filter(is_pinned);
    pinned.clone().count() == face.len() || pinned.any(is_near)
}
