//! Cloth that is stiffer once it is stretched.

use bevy::reflect::{Reflect, std_traits::ReflectDefault};

use crate::cloth::quantity::{Allowed, QuantityError};

/// A knit gives easily until its loops are straight, and its yarns take over. Beyond a strain, cloth that stiffens is stiffer against
/// stretch and shear, by a factor. Force over strain is a line with a knee:
///
/// ```text
/// force           /
///   |            /    factor × as steep
///   |           /
///   |       __-´
///   |   __-´
///   o-´────────┴──── strain
/// ```
///
/// A grid that stiffens is solved as a mesh, which takes two to four times as long. A rope does not
/// stiffen, and what is rigid stays rigid.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
pub struct ClothStiffening {
    /// The strain from which on it is stiffer: elongation over length at rest. Positive, at most 10.
    pub strain: f32,
    /// How many times as stiff it is there. At least 1, finite.
    pub factor: f32,
}

impl Default for ClothStiffening {
    /// Ten times as stiff beyond a strain of 0.2. Both are guesses.
    fn default() -> Self {
        Self {
            strain: 0.2,
            factor: 10.0,
        }
    }
}

impl ClothStiffening {
    /// Checks that both values are in their ranges.
    ///
    /// # Errors
    /// [`QuantityError`] for the first that is not.
    pub(super) fn validate(&self) -> Result<(), QuantityError> {
        let strain = Allowed(|of| of > 0.0 && of <= 10.0, "positive, and at most 10");
        strain.check("strain beyond which the cloth stiffens", [self.strain])?;
        let factor = Allowed(|of| of >= 1.0 && of.is_finite(), "at least 1, and finite");
        factor.check("factor by which the cloth stiffens", [self.factor])
    }

    /// The strain under a load that would strain a cloth by `linear` if it did not stiffen.
    pub(crate) fn strain_of(&self, linear: f32) -> f32 {
        let beyond = (linear - self.strain).max(0.0);
        linear - beyond + beyond / self.factor
    }
}
