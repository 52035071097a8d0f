//! How a cloth touches cloth.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::{ClothError, Surface};

/// Of the shortest spacing, how thick a cloth may be at most: what is thicker would push its own neighbours.
const MAX_OF_SPACING: f32 = 0.5;

/// On a cloth: it touches itself, and each other cloth that has this too, unless their layers say otherwise. Without it cloth
/// passes through cloth, and costs nothing.
///
/// Layers are kept a thickness apart, from middle to middle, by vertices against faces and by edges against edges, each as heavy
/// as it is; friction acts between them by Coulomb's law. Between two cloths the mean of their thicknesses counts, and the
/// geometric mean of their friction.
///
/// Spawn cloths at least a thickness apart: those that begin inside each other cost seconds a tick. The log names them.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// let of_a_towel = ClothSelfCollision {
///     thickness: 0.004,
///     friction: 0.6,
///     ..ClothSelfCollision::default()
/// };
/// ```
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothSelfCollision {
    /// How far the middles of two layers are kept apart (m): more than 0, and at most half of the shortest spacing at rest. Thick cloth
    /// is safer at high speeds; 5 mm by default. Layers that rest on each other may be nearer by a twenty-fifth.
    pub thickness: f32,
    /// Coulomb's μ between layers, 0 or more.
    pub friction: f32,
    /// Whether it touches itself; if not, it touches others alone.
    pub with_itself: bool,
}

impl Default for ClothSelfCollision {
    fn default() -> Self {
        Self {
            thickness: 0.005,
            friction: 0.3,
            with_itself: true,
        }
    }
}

impl ClothSelfCollision {
    /// With layers kept so far apart (m).
    pub fn of_thickness(thickness: f32) -> Self {
        Self {
            thickness,
            ..Self::default()
        }
    }

    /// Checks all values against the surface of the cloth.
    ///
    /// # Errors
    /// A thickness that is not positive; [`ClothError::TooThick`] for more than half of the shortest spacing; friction that is
    /// negative or not finite.
    pub fn validate(&self, surface: &Surface) -> Result<(), ClothError> {
        let thickness = ClothError::check(
            self.thickness,
            |thickness| thickness > 0.0 && thickness.is_finite(),
            "the thickness for contact of cloth with cloth (m)",
            "positive",
        )?;
        let shortest = surface.spacing().shortest;
        if thickness > MAX_OF_SPACING * shortest {
            return Err(ClothError::TooThick {
                thickness,
                shortest,
            });
        }
        ClothError::check(
            self.friction,
            |friction| friction >= 0.0 && friction.is_finite(),
            "friction between layers of cloth (1)",
            "zero or more",
        )?;
        Ok(())
    }
}
