//! The density of a cloth, particle by particle.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{error::ClothError, particles::DensityFactors, skin::ClothPaint, surface::Surface};

/// Scales a cloth's areal density, particle by particle: wet below the knee, a weighted hem. Without this component, the
/// density is the material's. It may change in every tick: only masses change then, and velocities stay. A change also
/// replaces masses that the game set individually. Tethers, and limits that rest on weight, go by the material's own density.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// // Wet below 0.4 m at rest: it weighs twice as much there.
/// let wet = ClothDensity::added(ClothPaint::at_rest(|place| if place.y < 0.4 { 1.0 } else { 0.0 }));
/// // Full red is four times as heavy; without red it is the material's.
/// let hem = ClothDensity::added(ClothPaint::color(0, 3.0));
/// # let _ = (wet, hem);
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothDensity {
    /// The factor where nothing is painted; 1 by default. Zero or more.
    pub base: f32,
    /// Added to it, particle by particle. The sum has to be positive and finite.
    pub paint: ClothPaint,
}

impl Default for ClothDensity {
    /// 1 everywhere.
    fn default() -> Self {
        Self::added(0.0)
    }
}

impl ClothDensity {
    /// Adds parts of the material's density to it: 0 adds nothing, 1 doubles it.
    pub fn added(paint: impl Into<ClothPaint>) -> Self {
        Self {
            base: 1.0,
            paint: paint.into(),
        }
    }

    /// The factor of each particle.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first that is not positive and finite; [`ClothError::NoSuchPaint`];
    /// [`ClothError::PaintCount`].
    pub(crate) fn factors(&self, surface: &Surface) -> Result<DensityFactors, ClothError> {
        let quantity = "factor of the density";
        let mut factors = self.paint.values(surface, quantity)?;
        ClothError::check(self.base, |base| base >= 0.0, quantity, "zero or more")?;
        let is_factor = |factor: f32| factor > 0.0 && factor.is_finite();
        for factor in &mut factors {
            *factor += self.base;
            ClothError::check(*factor, is_factor, quantity, "positive and finite")?;
        }
        Ok(DensityFactors(factors))
    }
}
