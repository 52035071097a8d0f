//! The identity of a source mesh.

use bevy::{asset::AssetId, mesh::Mesh};

/// A mesh, and how often it had been changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Source {
    pub mesh: AssetId<Mesh>,
    pub version: u32,
}
