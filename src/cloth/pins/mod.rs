//! Pinned particles.

mod names;
mod pin;

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};
use thiserror::Error;

use super::surface::Surface;

pub use pin::{Corner, Pin, PinPredicate, RestPredicate};

/// The pinned particles, which move only with the entity's transform. By default the top row of a grid, and nothing of
/// a mesh. May change at any time.
///
/// ```
/// use bevy::math::Vec3;
/// use bevy_drape::prelude::*;
///
/// let flag = Pins::new([Pin::Column(0)]);
/// let sheet = Pins::new([Pin::Corner(Corner::TopLeft), Pin::Corner(Corner::TopRight)]);
/// let curtain = Pins::filter(|row, column| row == 0 && column % 3 == 0);
/// let scarf = Pins::none();
/// // On a mesh: red paint of an artist, everything within 5 cm of a point, and everything above the waist.
/// let painted = Pins::new([Pin::color(0, 0.5)]);
/// let ring = Pins::new([Pin::Near { point: Vec3::new(0.0, 2.0, 0.0), radius: 0.05 }]);
/// let skirt = Pins::new([Pin::at_rest(|place| place.y > 1.0)]);
/// # let _ = (flag, sheet, curtain, scarf, painted, ring, skirt);
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct Pins(Vec<Pin>);

/// The reason why a pin holds nothing.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PinError {
    /// A pin names a particle outside the cloth.
    #[error("{pin} is outside a cloth of {cloth}")]
    OutOfRange {
        /// The pin.
        pin: String,
        /// The cloth's columns and rows, or its particles and vertices.
        cloth: String,
    },
    /// A pin names rows and columns, but the cloth is not a grid.
    #[error(
        "{pin} names rows and columns, but the cloth is a mesh: pin it by vertex, position, colour or attribute"
    )]
    NeedsGrid {
        /// The pin.
        pin: String,
    },
    /// A pin names a vertex attribute that the mesh does not have, or that is not numeric.
    #[error("{pin} needs an attribute that the mesh does not have; it has: {attributes}")]
    NoSuchAttribute {
        /// The pin.
        pin: String,
        /// The names of the mesh's attributes.
        attributes: String,
    },
    /// A pin by position, colour or attribute matches no particle.
    #[error("{pin} matches no particle of the cloth")]
    FindsNothing {
        /// The pin.
        pin: String,
    },
}

impl Default for Pins {
    fn default() -> Self {
        Self::new([Pin::Top])
    }
}

impl Pins {
    /// Pins everything that any of `pins` names.
    pub fn new(pins: impl IntoIterator<Item = Pin>) -> Self {
        Self(pins.into_iter().collect())
    }

    /// Pins nothing: the cloth falls.
    pub const fn none() -> Self {
        Self(Vec::new())
    }

    /// Pins the top row, as in the paper's scene.
    pub fn top_row() -> Self {
        Self::new([Pin::Row(0)])
    }

    /// Pins every particle for which `holds(row, column)` returns true.
    pub fn filter(holds: impl Fn(u32, u32) -> bool + Send + Sync + 'static) -> Self {
        Self::new([Pin::filter(holds)])
    }

    /// Checks that each pin names particles of `surface`.
    ///
    /// # Errors
    /// Those of [`Pin::validate`], for the first invalid pin.
    pub fn validate(&self, surface: &Surface) -> Result<(), PinError> {
        self.0.iter().try_for_each(|pin| pin.validate(surface))
    }

    /// All pins.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Pin> {
        self.0.iter()
    }

    /// Calls `pinned` with the index of each pinned particle of `surface`, possibly more than once. The pins must be
    /// valid for it.
    pub(crate) fn for_each(&self, surface: &Surface, mut pinned: impl FnMut(usize)) {
        for pin in &self.0 {
            pin.for_each(surface, &mut pinned);
            // A hand holds one part alone, a pin all of them.
            if let Pin::Index(index) = pin {
                let parts = surface.copies().filter(|(_, of)| *of as usize == *index);
                parts.for_each(|(part, _)| pinned(part as usize));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;
    use crate::cloth::Corner;
    use bevy::math::Vec3;

    fn pinned(pins: &Pins) -> Vec<usize> {
        let surface = Cloth::new(4, 3, 0.5)
            .surface(Vec3::ONE)
            .expect("a valid grid");
        let mut indices = Vec::new();
        pins.for_each(&surface, |index| indices.push(index));
        indices
    }

    #[test]
    fn each_way_of_naming_pins_the_right_particles() {
        assert_eq!(pinned(&Pins::default()), [0, 1, 2, 3]);
        assert!(pinned(&Pins::none()).is_empty());
        assert_eq!(pinned(&Pins::new([Pin::Index(6), Pin::Cell(2, 1)])), [6, 9]);
        assert_eq!(pinned(&Pins::new([Pin::Column(3)])), [3, 7, 11]);
        let corners = [
            Corner::TopLeft,
            Corner::TopRight,
            Corner::BottomLeft,
            Corner::BottomRight,
        ];
        assert_eq!(pinned(&Pins::new(corners.map(Pin::Corner))), [0, 3, 8, 11]);
        assert_eq!(
            pinned(&Pins::filter(|row, column| row == column)),
            [0, 5, 10]
        );
    }

    #[test]
    fn a_pin_outside_is_named() {
        let surface = Cloth::new(4, 3, 0.5)
            .surface(Vec3::ONE)
            .expect("a valid grid");
        for pin in [
            Pin::Index(12),
            Pin::Cell(0, 4),
            Pin::Cell(3, 0),
            Pin::Row(3),
            Pin::Column(4),
        ] {
            let error = Pins::new([Pin::Row(0), pin.clone()]).validate(&surface);
            assert_eq!(
                error,
                Err(PinError::OutOfRange {
                    pin: format!("{pin:?}"),
                    cloth: "4 columns × 3 rows".into()
                })
            );
        }
    }
}
