//! The identity of a source mesh.

#[cfg(feature = "mesh")]
use bevy::{asset::AssetId, mesh::Mesh};

/// A mesh, and how often it had been changed.
#[cfg(feature = "mesh")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Source {
    pub mesh: AssetId<Mesh>,
    pub version: u32,
}

/// Without Bevy's meshes there is none.
#[cfg(not(feature = "mesh"))]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Source {}
