//! What is inside of a closed cloth.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::{ClothError, Surface};

/// Mean pressure of the air at sea level (Pa), of the International Standard Atmosphere (ISO 2533).
const ATMOSPHERE: f32 = 101_325.0;

/// What presses a closed cloth from within: a balloon, a cushion, an air bed. The cloth has to be a mesh without holes, of one or
/// several pieces; a hole is a `ClothFault`. Whichever side its faces are turned to, the pressure is that of the inside.
///
/// May change at any time; nothing is built again.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothPressure {
    /// That of the inside over that of the outside (Pa), as of what a fan or a pump holds; negative where it is sucked empty. From −10⁹
    /// to 10⁹.
    Gauge(f32),
    /// An amount of gas, which no more comes into and none leaves: as much as fills `volume` (m³, up to 10⁹) at the pressure `outside` of
    /// what surrounds the cloth (Pa, up to 10⁹). Where the cloth encloses V, its pressure over that is outside · (volume/V − 1), Boyle's law.
    /// A mesh that is too small for its gas is taut, one that is larger is slack, and a body that sits down on it is carried. However flat
    /// it is pressed, faces are blown out by no more than 10 m/s.
    Gas {
        /// Volume at the pressure outside (m³).
        volume: f32,
        /// Pressure outside (Pa).
        outside: f32,
    },
}

impl Default for ClothPressure {
    /// None: as much inside as outside.
    fn default() -> Self {
        Self::Gauge(0.0)
    }
}

impl ClothPressure {
    /// Gas that fills `volume` (m³) in the open, at the sea.
    pub const fn gas(volume: f32) -> Self {
        Self::Gas {
            volume,
            outside: ATMOSPHERE,
        }
    }

    /// Whether each value is in its range, and `surface` encloses a volume.
    ///
    /// # Errors
    /// [`ClothError::Quantity`], and [`ClothError::NotClosed`].
    pub fn validate(&self, surface: &Surface) -> Result<(), ClothError> {
        match *self {
            Self::Gauge(pressure) => {
                let is_moderate = |p: f32| p.abs() <= 1.0e9;
                let name = "gauge pressure (Pa)";
                ClothError::check(pressure, is_moderate, name, "from −10⁹ to 10⁹")?;
            }
            Self::Gas { volume, outside } => {
                let is_some = |of: f32| of > 0.0 && of <= 1.0e9;
                let range = "above 0, up to 10⁹";
                ClothError::check(volume, is_some, "volume of the gas (m³)", range)?;
                ClothError::check(outside, is_some, "pressure outside (Pa)", range)?;
            }
        }
        if surface.is_closed() {
            Ok(())
        } else {
            Err(ClothError::NotClosed)
        }
    }
}
