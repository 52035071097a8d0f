//! Settings for contact of cloth with cloth.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::{Allowed, ClothError, SelfCollisionError, Surface};

/// Largest thickness, as a fraction of the shortest spacing: a thicker cloth would push its own neighbours.
const MAX_OF_SPACING: f32 = 0.5;

/// Makes a cloth collide with itself, and with every other cloth that has this component, unless their layers exclude
/// it. Without it, cloth passes through cloth, at no cost.
///
/// Layers are kept a thickness apart, measured between their middles. Vertices collide with faces, and edges with
/// edges, each with its own mass. Friction between them follows Coulomb's law. Between two cloths, the mean of their
/// thicknesses and the geometric mean of their friction coefficients count.
///
/// Spawn cloths at least a thickness apart: where they begin inside each other they are left alone until they have come
/// apart. The log names them.
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
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothSelfCollision {
    /// Distance between the middles of two layers (m): positive, and at most half of the shortest spacing at rest; 5 mm
    /// by default. Thick cloth is safer at high speeds. Resting layers may be up to a twenty-fifth closer.
    /// [`ClothMaterialMap::thickness`](crate::cloth::ClothMaterialMap::thickness) makes parts of it thinner.
    pub thickness: f32,
    /// Coulomb's μ between layers, zero or more.
    pub friction: f32,
    /// Whether the cloth collides with itself; otherwise it collides only with others.
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
    /// The default settings with this thickness (m).
    pub fn of_thickness(thickness: f32) -> Self {
        Self {
            thickness,
            ..Self::default()
        }
    }

    /// Checks all values against the surface of the cloth.
    ///
    /// # Errors
    /// [`QuantityError`](crate::cloth::QuantityError) for a thickness that is not positive, or a friction that is negative
    /// or not finite;
    /// [`SelfCollisionError::TooThick`] for more than half of the shortest spacing.
    pub fn validate(&self, surface: &Surface) -> Result<(), ClothError> {
        let thickness = self.thickness;
        Allowed::LENGTH.check("the thickness of self-colliding cloth (m)", [thickness])?;
        let shortest = surface.spacing().shortest;
        if thickness > MAX_OF_SPACING * shortest {
            return Err(ClothError::SelfCollision(SelfCollisionError::TooThick {
                thickness,
                shortest,
            }));
        }
        let size = Allowed(|v| v >= 0.0 && v.is_finite(), "zero or more");
        Ok(size.check("friction between layers of cloth (1)", [self.friction])?)
    }
}
