//! Where the triangles of a cloth from a mesh come from.

#[cfg(feature = "mesh")]
mod asset;
#[cfg(feature = "mesh")]
mod id;
#[cfg(not(feature = "mesh"))]
mod none;

#[cfg(feature = "mesh")]
pub(super) use asset::{ChangedMeshes, Sources, note_changed_meshes};
#[cfg(feature = "mesh")]
pub(super) use id::Source;
#[cfg(not(feature = "mesh"))]
pub(super) use none::{Source, Sources};
