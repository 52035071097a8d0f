//! Which mesh something is made from.

use bevy::{asset::AssetId, mesh::Mesh};

/// Which mesh, and how often it had been changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Source {
    pub mesh: AssetId<Mesh>,
    pub version: u32,
}
