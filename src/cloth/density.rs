//! The density of a cloth, particle by particle.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{error::ClothError, particles::DensityFactors, skin::ClothPaint, surface::Surface};

/// Factors of a cloth's areal density, particle by particle: wet below the knee, a weighted hem. Without this component, all
/// are 1. It may change in every tick: only masses change then, and velocities stay. A change also replaces masses that
/// the game set individually. Tethers are made for the material's own density.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// // Wet below 0.4 m at rest: it weighs twice as much there.
/// let wet = ClothDensity(ClothPaint::at_rest(|place| if place.y < 0.4 { 2.0 } else { 1.0 }));
/// # let _ = wet;
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothDensity(
    /// Positive and finite.
    pub ClothPaint,
);

impl Default for ClothDensity {
    /// 1 everywhere.
    fn default() -> Self {
        Self(ClothPaint::Uniform(1.0))
    }
}

impl ClothDensity {
    /// The factor of each particle.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first that is not positive and finite; [`ClothError::NoSuchPaint`];
    /// [`ClothError::PaintCount`].
    pub(crate) fn factors(&self, surface: &Surface) -> Result<DensityFactors, ClothError> {
        let quantity = "factor of the density";
        let factors = self.0.values(surface, quantity)?;
        let is_factor = |factor: f32| factor > 0.0 && factor.is_finite();
        for factor in &factors {
            ClothError::check(*factor, is_factor, quantity, "positive and finite")?;
        }
        Ok(DensityFactors(factors))
    }
}
