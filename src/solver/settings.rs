//! How a cloth is simulated.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::ClothError;

/// More would be a slip of the finger, and would hang the game.
const MOST_SUBSTEPS: u32 = 10_000;

/// How a cloth is simulated. May change at any time.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothSettings {
    /// Sub-steps a tick, from 1 to 10,000. Cost grows in proportion, and stretch shrinks: a sub-step's sweep is as
    /// stiff as mass/Δt².
    pub substeps: u32,
    /// Acceleration in the world (m/s²) for this cloth alone, instead of the resource
    /// [`ClothGravity`](crate::plugin::ClothGravity).
    pub gravity: Option<Vec3>,
    /// Radius of each particle (m), zero or more: the distance at which the cloth lies on a collider, and the
    /// radius of the tree's leaves. About spacing² / (4 × the ball's radius) keeps the flat triangles between
    /// the particles from sinking into a ball.
    pub particle_radius: f32,
}

impl Default for ClothSettings {
    /// 20 sub-steps, the resource's gravity, particles of 1 cm radius.
    fn default() -> Self {
        Self {
            substeps: 20,
            gravity: None,
            particle_radius: 0.01,
        }
    }
}

impl ClothSettings {
    /// Whether each value is in its range.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        ClothError::check(
            self.substeps as f32,
            |v| (1.0..=MOST_SUBSTEPS as f32).contains(&v),
            "sub-steps",
            "from 1 to 10,000",
        )?;
        ClothError::check(
            self.particle_radius,
            |v| v >= 0.0 && v.is_finite(),
            "particle radius (m)",
            "zero or more, and finite",
        )?;
        for value in self.gravity.unwrap_or(Vec3::ZERO).to_array() {
            ClothError::check(value, f32::is_finite, "gravity (m/s²)", "finite")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bad_value_is_named() {
        let good = ClothSettings::default();
        assert_eq!(good.validate(), Ok(()));
        for (settings, name) in [
            (
                ClothSettings {
                    substeps: 0,
                    ..good
                },
                "sub-steps",
            ),
            (
                ClothSettings {
                    particle_radius: -0.1,
                    ..good
                },
                "radius",
            ),
            (
                ClothSettings {
                    particle_radius: f32::NAN,
                    ..good
                },
                "radius",
            ),
            (
                ClothSettings {
                    gravity: Some(Vec3::INFINITY),
                    ..good
                },
                "gravity",
            ),
        ] {
            assert!(
                settings
                    .validate()
                    .expect_err(name)
                    .to_string()
                    .contains(name)
            );
        }
    }
}
