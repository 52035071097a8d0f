//! The gravity of all cloths.

use bevy::prelude::{Reflect, ReflectDefault, ReflectResource, Resource, Vec3};

/// Gravitational acceleration of every cloth (m/s²), in the world.
/// [`ClothSettings::gravity`](crate::solver::ClothSettings::gravity) overrides it for a single cloth.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct ClothGravity(pub Vec3);

impl Default for ClothGravity {
    /// 9.81 m/s² downwards.
    fn default() -> Self {
        Self(Vec3::new(0.0, -9.81, 0.0))
    }
}
