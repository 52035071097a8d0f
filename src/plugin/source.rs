//! Where the triangles of a cloth from a mesh come from.

#[cfg(not(feature = "mesh"))]
mod none;
#[cfg(feature = "mesh")]
mod asset;

#[cfg(feature = "mesh")]
pub(super) use asset::{ChangedMeshes, Source, Sources, note_changed_meshes};
#[cfg(not(feature = "mesh"))]
pub(super) use none::{Source, Sources};
