//! How deep particles are inside of something: over all of them, in f64.

use bevy::math::Isometry3d;

use super::ColliderShape;
use crate::cloth::ClothParticles;

/// How deep the deepest free particle is inside of a shape in a pose of the cloth's frame (m), 0 if none is.
///
/// A box has no depth of its own here: what is inside of it counts as deep as the particle's radius.
pub fn deepest_penetration(
    particles: &ClothParticles,
    shape: &ColliderShape,
    pose: Isometry3d,
    particle_radius: f32,
) -> f64 {
    let (core, radius) = shape.core(pose);
    let reach = f64::from(radius) + f64::from(particle_radius);
    let free = particles
        .positions()
        .zip(particles.inverse_masses())
        .filter(|&(_, mass)| mass > 0.0);
    let depth = free.map(|(position, _)| reach - core.distance(position));
    depth.fold(0.0, f64::max)
}
