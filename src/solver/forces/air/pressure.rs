//! The pressure inside a closed cloth.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::gas::FILLING;
use crate::cloth::{Allowed, ClothError, MeshError, Surface};

/// Mean pressure of the air at sea level (Pa), of the International Standard Atmosphere (ISO 2533).
const ATMOSPHERE: f32 = 101_325.0;

/// Pressure inside a closed cloth: a balloon, a cushion, an air bed. The cloth has to be a mesh without holes, of one
/// or several pieces; a hole is a `ClothFault`. Faces may be oriented to either side: the pressure always acts from the
/// inside.
///
/// It may change at any time; nothing is built again.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothPressure {
    /// A constant gauge pressure: the inside less the outside (Pa), as a fan or a pump maintains it. Negative for
    /// suction. From −10⁹ to 10⁹.
    Gauge(f32),
    /// A fixed amount of gas: as much as fills `volume` (m³, up to 10⁹) at the pressure `outside` the cloth (Pa, up to
    /// 10⁹). A cloth that encloses V has the gauge pressure outside · (volume/V − 1), by Boyle's law. A mesh that is
    /// too small for its gas is taut, and a larger mesh is slack. Gas carries a body that sits down on it. However flat
    /// the mesh is pressed, its faces are blown out with at most 10 m/s.
    Gas {
        /// Volume of the gas at the pressure outside (m³).
        volume: f32,
        /// Pressure outside (Pa).
        outside: f32,
    },
}

impl Default for ClothPressure {
    /// No gauge pressure: the same inside as outside.
    fn default() -> Self {
        Self::Gauge(0.0)
    }
}

impl ClothPressure {
    /// Gas that fills `volume` (m³) in the open at sea level.
    pub const fn gas(volume: f32) -> Self {
        Self::Gas {
            volume,
            outside: ATMOSPHERE,
        }
    }

    /// Checks that each value is in its range, and that `surface` encloses a volume.
    ///
    /// # Errors
    /// [`QuantityError`](crate::cloth::QuantityError), and [`MeshError::NotClosed`].
    pub fn validate(&self, surface: &Surface) -> Result<(), ClothError> {
        match *self {
            Self::Gauge(pressure) => {
                let moderate = Allowed(|p| p.abs() <= 1.0e9, "from −10⁹ to 10⁹");
                moderate.check("gauge pressure (Pa)", [pressure])?;
            }
            Self::Gas { volume, outside } => {
                let some = Allowed(|of| of > 0.0 && of <= 1.0e9, "above 0, up to 10⁹");
                some.check("volume of the gas (m³)", [volume])?;
                some.check("pressure outside (Pa)", [outside])?;
            }
        }
        if surface.is_closed() {
            Ok(())
        } else {
            Err(MeshError::NotClosed.into())
        }
    }

    /// Largest acceleration (m/s²) that it may give a cloth of this areal density (kg/m²) within `seconds`: gas does not
    /// accelerate it beyond the speed at which it fills.
    pub(crate) fn acceleration(&self, areal_density: f32, seconds: f32) -> f32 {
        match self {
            Self::Gauge(pressure) => pressure.abs() / areal_density,
            Self::Gas { .. } if seconds > 0.0 => FILLING / seconds,
            // Gas fills nothing in zero time.
            Self::Gas { .. } => 0.0,
        }
    }
}
