//! Questions about a cloth, answered for whoever acts on it.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::random::Random;

/// The surface of a cloth that has been built.
pub fn surface_of(world: &World, cloth: Entity) -> Option<Arc<Surface>> {
    let surface = world.get::<ClothBuilt>(cloth)?.surface();
    (!surface.is_empty()).then(|| surface.clone())
}

/// The place of one of its particles in the world (m), often of a pinned one.
pub fn place_of(world: &World, cloth: Entity, random: &mut Random) -> Option<Vec3> {
    let particles = world.get::<ClothParticles>(cloth)?;
    let frame = world.get::<ClothFrame>(cloth)?;
    let masses = particles.inverse_masses().enumerate();
    let pinned: Vec<usize> = masses
        .filter(|(_, mass)| *mass == 0.0)
        .map(|(index, _)| index)
        .collect();
    let index = match random.one_in(3) {
        true => random.pick(&pinned).copied().unwrap_or(0),
        false => random.below(particles.len()),
    };
    particles.position(index).map(|at| frame.to_world(at))
}
