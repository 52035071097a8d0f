//! How deep a cloth is in a collider as a tick ends, by brute force in f64.

use bevy::{ecs::query::QueryData, prelude::*};
use bevy_drape::{contact::deepest_penetration, prelude::*};

/// A cloth, and where it is.
#[derive(QueryData)]
pub struct Placed {
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    settings: &'static ClothSettings,
}

impl PlacedItem<'_, '_> {
    /// The deepest that any particle is (mm).
    pub fn depth_in(&self, collider: &ClothCollider, place: &Transform) -> f64 {
        let Ok(shape) = collider.scaled(place.scale) else {
            return 0.0;
        };
        let pose = self.frame.isometry().inverse() * place.to_isometry();
        let radius = self.settings.particle_radius;
        1.0e3 * deepest_penetration(self.particles, &shape, pose, radius)
    }
}
