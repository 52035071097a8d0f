//! How a particle is named.

use bevy::reflect::Reflect;

/// Which particle: an index, or (row, column).
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
pub enum ParticleId {
    /// `row × columns + column`.
    Index(usize),
    /// (row, column), from the top left.
    Cell(u32, u32),
}

impl From<usize> for ParticleId {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

impl From<(u32, u32)> for ParticleId {
    fn from((row, column): (u32, u32)) -> Self {
        Self::Cell(row, column)
    }
}
