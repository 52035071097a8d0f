//! The sources of triangles of cloths and colliders that are made from meshes.

#[cfg(feature = "mesh")]
mod asset;
#[cfg(feature = "mesh")]
mod changes;
#[cfg(feature = "mesh")]
mod collider;
mod id;
#[cfg(not(feature = "mesh"))]
mod none;

#[cfg(feature = "mesh")]
pub(super) use asset::{ChangedMeshes, Sources};
#[cfg(feature = "mesh")]
pub(super) use changes::note_changed_meshes;
#[cfg(feature = "mesh")]
pub(super) use collider::{ColliderMeshes, SharedMeshes};
pub(super) use id::Source;
#[cfg(not(feature = "mesh"))]
pub(super) use none::{ColliderMeshes, Sources};
