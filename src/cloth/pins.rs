//! Which particles hold still.

use std::{fmt, sync::Arc};

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{ClothError, ClothGrid};

/// A corner of the cloth at rest, seen from where it faces: +z, of a lying cloth +y.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq)]
pub enum Corner {
    /// (0, 0).
    TopLeft,
    /// (0, columns − 1).
    TopRight,
    /// (rows − 1, 0).
    BottomLeft,
    /// (rows − 1, columns − 1).
    BottomRight,
}

/// Particles to pin.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub enum Pin {
    /// The particle with this index.
    Index(usize),
    /// The particle at (row, column).
    Cell(u32, u32),
    /// A whole row, 0 at the top.
    Row(u32),
    /// A whole column, 0 at the left.
    Column(u32),
    /// One corner.
    Corner(Corner),
    /// Every particle whose (row, column) it holds for. Code can't be saved: in a scene file it pins nothing.
    Where(#[reflect(ignore)] PinPredicate),
}

/// Whether the particle at (row, column) is pinned. By default none is.
#[derive(Clone)]
pub struct PinPredicate(Arc<dyn Fn(u32, u32) -> bool + Send + Sync>);

impl PinPredicate {
    /// Every particle whose (row, column) `holds`.
    pub fn new(holds: impl Fn(u32, u32) -> bool + Send + Sync + 'static) -> Self {
        Self(Arc::new(holds))
    }
}

impl Default for PinPredicate {
    fn default() -> Self {
        Self::new(|_, _| false)
    }
}

impl fmt::Debug for PinPredicate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("..")
    }
}

impl PartialEq for PinPredicate {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Pin {
    /// Every particle whose (row, column) `holds`.
    pub fn filter(holds: impl Fn(u32, u32) -> bool + Send + Sync + 'static) -> Self {
        Self::Where(PinPredicate::new(holds))
    }

    /// Whether it names particles of `grid`.
    ///
    /// # Errors
    /// [`ClothError::PinOutOfRange`] if it does not.
    pub fn validate(&self, grid: &ClothGrid) -> Result<(), ClothError> {
        let is_inside = match *self {
            Self::Index(index) => index < grid.len(),
            Self::Cell(row, column) => row < grid.rows() && column < grid.columns(),
            Self::Row(row) => row < grid.rows(),
            Self::Column(column) => column < grid.columns(),
            Self::Corner(_) | Self::Where(_) => true,
        };
        if is_inside {
            return Ok(());
        }
        Err(ClothError::PinOutOfRange {
            pin: self.clone(),
            columns: grid.columns(),
            rows: grid.rows(),
        })
    }

    /// Calls `pinned` with the index of each particle of `grid` that it names. It must be valid for it.
    pub(crate) fn for_each(&self, grid: &ClothGrid, mut pinned: impl FnMut(usize)) {
        let (rows, columns) = (grid.rows(), grid.columns());
        let (last_row, last_column) = (rows - 1, columns - 1);
        let mut cell = |row, column| pinned(grid.index(row, column) as usize);
        match self {
            Self::Index(index) => cell(*index as u32 / columns, *index as u32 % columns),
            Self::Cell(row, column) => cell(*row, *column),
            Self::Row(row) => (0..columns).for_each(|column| cell(*row, column)),
            Self::Column(column) => (0..rows).for_each(|row| cell(row, *column)),
            Self::Corner(Corner::TopLeft) => cell(0, 0),
            Self::Corner(Corner::TopRight) => cell(0, last_column),
            Self::Corner(Corner::BottomLeft) => cell(last_row, 0),
            Self::Corner(Corner::BottomRight) => cell(last_row, last_column),
            Self::Where(PinPredicate(holds)) => grid
                .cells()
                .filter(|&(row, column)| holds(row, column))
                .for_each(|(row, column)| cell(row, column)),
        }
    }
}

/// Which particles are pinned: they move with the entity's transform and with nothing else. The top row
/// unless said otherwise. May change at any time.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// let flag = Pins::new([Pin::Column(0)]);
/// let sheet = Pins::new([Pin::Corner(Corner::TopLeft), Pin::Corner(Corner::TopRight)]);
/// let curtain = Pins::filter(|row, column| row == 0 && column % 3 == 0);
/// let scarf = Pins::none();
/// # let _ = (flag, sheet, curtain, scarf);
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct Pins(Vec<Pin>);

impl Default for Pins {
    fn default() -> Self {
        Self::top_row()
    }
}

impl Pins {
    /// All of `pins` together.
    pub fn new(pins: impl IntoIterator<Item = Pin>) -> Self {
        Self(pins.into_iter().collect())
    }

    /// Nothing is pinned: the cloth falls.
    pub const fn none() -> Self {
        Self(Vec::new())
    }

    /// The top row, as in the paper's scene.
    pub fn top_row() -> Self {
        Self::new([Pin::Row(0)])
    }

    /// Every particle whose (row, column) `holds`.
    pub fn filter(holds: impl Fn(u32, u32) -> bool + Send + Sync + 'static) -> Self {
        Self::new([Pin::filter(holds)])
    }

    /// Whether each pin names particles of `grid`.
    ///
    /// # Errors
    /// [`ClothError::PinOutOfRange`] for the first that does not.
    pub fn validate(&self, grid: &ClothGrid) -> Result<(), ClothError> {
        self.0.iter().try_for_each(|pin| pin.validate(grid))
    }

    /// Calls `pinned` with the index of each pinned particle of `grid`, some perhaps twice. The pins must be
    /// valid for it.
    pub(crate) fn for_each(&self, grid: &ClothGrid, mut pinned: impl FnMut(usize)) {
        self.0
            .iter()
            .for_each(|pin| pin.for_each(grid, &mut pinned));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;
    use bevy::math::Vec3;

    fn pinned(pins: &Pins) -> Vec<usize> {
        let grid = Cloth::new(4, 3, 0.5).grid(Vec3::ONE).expect("a sound grid");
        let mut indices = Vec::new();
        pins.for_each(&grid, |index| indices.push(index));
        indices
    }

    #[test]
    fn each_way_of_naming_pins_the_right_particles() {
        assert_eq!(pinned(&Pins::default()), [0, 1, 2, 3]);
        assert_eq!(pinned(&Pins::none()), []);
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
        let grid = Cloth::new(4, 3, 0.5).grid(Vec3::ONE).expect("a sound grid");
        for pin in [
            Pin::Index(12),
            Pin::Cell(0, 4),
            Pin::Cell(3, 0),
            Pin::Row(3),
            Pin::Column(4),
        ] {
            let error = Pins::new([Pin::Row(0), pin.clone()]).validate(&grid);
            assert_eq!(
                error,
                Err(ClothError::PinOutOfRange {
                    pin,
                    columns: 4,
                    rows: 3
                })
            );
        }
    }
}
