//! The sources of joints and cameras, and of triangles of cloths and colliders that are made from meshes.

#[cfg(feature = "mesh")]
mod asset;
#[cfg(feature = "mesh")]
mod cameras;
#[cfg(feature = "mesh")]
mod collider;
#[cfg(feature = "mesh")]
mod joints;
#[cfg(not(feature = "mesh"))]
mod none;

#[cfg(feature = "mesh")]
pub(crate) use asset::{ChangedMeshes, Sources, not_there};
#[cfg(feature = "mesh")]
pub(crate) use cameras::Cameras;
#[cfg(feature = "mesh")]
pub(crate) use collider::{ColliderMeshes, SharedMeshes, note_changed_meshes};
#[cfg(feature = "mesh")]
pub(crate) use joints::Skins;
#[cfg(not(feature = "mesh"))]
pub(crate) use none::{
    Nothing as Cameras, Nothing as ColliderMeshes, Nothing as Skins, Nothing as Sources,
};
