//! The picture: meshes that follow the particles, and gizmos. Drawn once a frame; in each tick, the positions at its beginning
//! are remembered.
//!
//! In: particles of the last two ticks, drawn transforms, visibility. Out: vertices of meshes, and lines.

#[cfg(feature = "pbr")]
mod fabric;
#[cfg(feature = "gizmos")]
mod gizmos;
#[cfg(feature = "mesh")]
mod mesh;
#[cfg(feature = "mesh")]
mod render_mesh;

#[cfg(feature = "pbr")]
pub use fabric::fabric;
#[cfg(feature = "gizmos")]
pub use gizmos::{ClothGizmos, ClothGizmosPlugin, ShowClothGizmos};
#[cfg(feature = "mesh")]
pub use mesh::ClothMeshPlugin;
#[cfg(feature = "mesh")]
pub(crate) use mesh::MeshDrawing;
#[cfg(feature = "mesh")]
pub use render_mesh::{ClothRenderMesh, ClothRenderMeshPlugin};
