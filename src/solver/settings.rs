//! Settings of a cloth's simulation.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    step::TimeOrder,
    substepping::{MAX_SUBSTEPS, Substepping},
};
use crate::cloth::{Allowed, QuantityError};

/// Settings of a cloth's simulation. They may change at any time.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothSettings {
    /// The number of sub-steps, which sets accuracy and cost: automatic, fixed, or by a tolerance of stretch.
    pub substepping: Substepping,
    /// Gravity for this cloth alone, in the world (m/s²), in place of the resource
    /// [`ClothGravity`](crate::plugin::ClothGravity).
    pub gravity: Option<Vec3>,
    /// Radius of each particle (m), zero or more: the distance at which the cloth lies on a collider, and the radius of
    /// the tree's leaves. With about spacing² / (4 × the ball's radius), the flat triangles between particles do not
    /// sink into a ball.
    pub particle_radius: f32,
    /// Whether tethers limit the distance of each particle from the pins to the length of cloth between them, with room
    /// for the stretch of the material and 1 % more. Solved chains don't need them. They reduce the stretch of a fine
    /// cloth that hangs by single points and runs with fewer sub-steps than it needs: see [`Tethers`](crate::solver::Tethers).
    pub tethers: bool,
    /// Order of the motion in time: the error falls with the square of a sub-step's length, or, as in the paper, in
    /// proportion to it. In second order, the springs of soft grids act by explicit forces where that is stable.
    pub order: TimeOrder,
    /// Whether a cloth that has come to rest sleeps. A sleeping cloth costs next to nothing, and stays as it is to the
    /// last bit. It wakes when a collider moves near it, a pin moves, or its components or gravity change.
    pub sleeps: bool,
}

impl Default for ClothSettings {
    /// Automatic sub-steps, second order, the resource's gravity, particles with a radius of 1 cm, sleep, and no
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
    /// A fixed number of sub-steps per tick, with defaults for everything else.
    pub fn substeps(substeps: u32) -> Self {
        Self {
            substepping: Substepping::Fixed(substeps),
            ..Default::default()
        }
    }

    /// A largest stretch (0.01 is one per cent), held with up to 100 sub-steps per tick, with defaults for everything
    /// else.
    pub fn tolerance(stretch: f32) -> Self {
        Self {
            substepping: Substepping::Adaptive {
                stretch,
                max_substeps: 100,
            },
            ..Default::default()
        }
    }

    /// Checks that each value is in its range.
    ///
    /// # Errors
    /// [`QuantityError`] for the first value that is not.
    pub fn validate(&self) -> Result<(), QuantityError> {
        let substeps = match self.substepping {
            Substepping::Automatic => 1,
            Substepping::Fixed(substeps) => substeps,
            Substepping::Adaptive {
                stretch,
                max_substeps,
            } => {
                Allowed::POSITIVE.check("tolerance of stretch", [stretch])?;
                max_substeps
            }
        };
        let range = |v: f32| (1.0..=MAX_SUBSTEPS as f32).contains(&v);
        Allowed(range, "from 1 to 10,000").check("sub-steps", [substeps as f32])?;
        Allowed::SIZE.check("particle radius (m)", [self.particle_radius])?;
        let gravity = self.gravity.unwrap_or(Vec3::ZERO);
        Allowed::FINITE.check("gravity (m/s²)", gravity.to_array())
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
