//! Triangles that hang by a pin right at a collider.

use crate::{cloth::ClothParticles, contact::MovingCollider};

/// Whether a triangle was pinned to something inside of a collider, or less than a radius of the particles (m) before it, as the tick
/// began, of which so many sub-steps have passed; or is pinned all around. It can't be brought out: who tried would push what hangs there in
/// every sub-step.
pub(super) fn is_sewn_on(
    face: &[u32; 3],
    collider: &MovingCollider,
    (passed, particle_radius): (u32, f32),
    particles: &ClothParticles,
) -> bool {
    let is_pinned = |corner: &&u32| particles.is_pinned(**corner as usize) == Some(true);
    let is_near = |corner: &u32| {
        let index = *corner as usize;
        // A pin goes evenly.
        let moved = particles.displacement(index).unwrap_or_default();
        let began = particles.position_at(index) - moved * passed as f32;
        collider.nearest(0.0, began).distance < particle_radius
    };
    let mut pinned = face.iter().filter(is_pinned);
    pinned.clone().count() == face.len() || pinned.any(is_near)
}
