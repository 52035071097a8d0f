//! How a cloth is simulated.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    TimeOrder,
    substepping::{MAX_SUBSTEPS, Substepping},
};
use crate::cloth::ClothError;

/// How a cloth is simulated. May change at any time.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothSettings {
    /// How exactly: as many sub-steps as the cloth needs, a number of them, or as many as hold a tolerance.
    pub substepping: Substepping,
    /// Acceleration in the world (m/s²) for this cloth alone, instead of the resource
    /// [`ClothGravity`](crate::plugin::ClothGravity).
    pub gravity: Option<Vec3>,
    /// Radius of each particle (m), zero or more: the distance at which the cloth lies on a collider, and the
    /// radius of the tree's leaves. About spacing² / (4 × the ball's radius) keeps the flat triangles between
    /// the particles from sinking into a ball.
    pub particle_radius: f32,
    /// Whether no particle may be farther from the pins than the cloth between them is long, with room for what the
    /// material gives and 1 % more. Threads that are solved need none; a fine cloth that hangs by single points and has to do
    /// with fewer sub-steps than it needs stretches less with them: see [`Tethers`](super::Tethers).
    pub tethers: bool,
    /// How the error of its motion falls with the sub-steps: in proportion to their length squared, or, as in the paper, to
    /// their length. Of second order, soft grids are pushed by their forces where that is stable.
    pub order: TimeOrder,
    /// Whether a cloth that has come to rest sleeps: it costs next to nothing, stays as it is to the last bit,
    /// and wakes by a collider that moves near it, a pin that moves, a change of its components or gravity.
    pub sleeps: bool,
}

impl Default for ClothSettings {
    /// As many sub-steps as the cloth needs, of second order, the resource's gravity, particles of 1 cm radius; sleep, and no
    /// tethers.
    fn default() -> Self {
        Self {
            substepping: Substepping::default(),
            gravity: None,
            particle_radius: 0.01,
            tethers: false,
            order: TimeOrder::default(),
            sleeps: true,
        }
    }
}

impl ClothSettings {
    /// A fixed number of sub-steps a tick, all else by default.
    pub fn substeps(substeps: u32) -> Self {
        Self {
            substepping: Substepping::Fixed(substeps),
            ..Default::default()
        }
    }

    /// A largest stretch (0.01 is one per cent) in place of sub-steps, of which a tick may have up to 100; all
    /// else by default.
    pub fn tolerance(stretch: f32) -> Self {
        Self {
            substepping: Substepping::Adaptive {
                stretch,
                max_substeps: 100,
            },
            ..Default::default()
        }
    }
}

impl ClothSettings {
    /// Whether each value is in its range.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        let substeps = match self.substepping {
            Substepping::Automatic => 1,
            Substepping::Fixed(substeps) => substeps,
            Substepping::Adaptive {
                stretch,
                max_substeps,
            } => {
                ClothError::check(
                    stretch,
                    |v| v > 0.0 && v.is_finite(),
                    "tolerance of stretch",
                    "positive and finite",
                )?;
                max_substeps
            }
        };
        ClothError::check(
            substeps as f32,
            |v| (1.0..=MAX_SUBSTEPS as f32).contains(&v),
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
            (ClothSettings::substeps(0), "sub-steps"),
            (ClothSettings::substeps(10_001), "sub-steps"),
            (ClothSettings::tolerance(0.0), "tolerance"),
            (ClothSettings::tolerance(f32::NAN), "tolerance"),
            (
                ClothSettings {
                    substepping: Substepping::Adaptive {
                        stretch: 0.01,
                        max_substeps: 0,
                    },
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
