//! What is inside of a closed cloth.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::Reflect,
};

use crate::cloth::{ClothError, Surface};

/// What presses a closed cloth from within: a balloon, a cushion, an air bed. The cloth has to be a mesh without holes, of one or
/// several pieces; a hole is a `ClothFault`. Whichever side its faces are turned to, the pressure is that of the inside.
///
/// May change at any time; nothing is built again.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Debug, Clone, PartialEq)]
pub enum ClothPressure {
    /// That of the inside over that of the outside (Pa), as of what a fan or a pump holds; negative where it is sucked empty. From −10⁹
    /// to 10⁹.
    Gauge(f32),
}

impl ClothPressure {
    /// Whether each value is in its range, and `surface` encloses a volume.
    ///
    /// # Errors
    /// [`ClothError::Quantity`], and [`ClothError::NotClosed`].
    pub fn validate(&self, surface: &Surface) -> Result<(), ClothError> {
        let Self::Gauge(pressure) = *self;
        let is_moderate = |p: f32| p.abs() <= 1.0e9;
        ClothError::check(
            pressure,
            is_moderate,
            "gauge pressure (Pa)",
            "from −10⁹ to 10⁹",
        )?;
        if surface.is_closed() {
            Ok(())
        } else {
            Err(ClothError::NotClosed)
        }
    }
}
