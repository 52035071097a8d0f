//! Which mesh a cloth is made from.

use bevy::{asset::AssetId, mesh::Mesh};

/// Which mesh, and how often it had been changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Source {
    pub mesh: AssetId<Mesh>,
    pub version: u32,
}
