//! Floor 2, contact: what a cloth touches, and the response.
//!
//! ```text
//!   colliders, friction → candidates → particles → triangles → edges ─┐
//!                                              bodies ────────────────┴→ detection        layers: cloth on cloth
//! ```
//!
//! A folder imports from those before it. [`Detection`] keeps what a cloth may touch in a tick, and pushes it out in each
//! sub-step. `MutualContact` does the same for cloth on cloth.

mod bodies;
mod candidates;
mod colliders;
mod detection;
mod edges;
mod friction;
mod layers;
mod particles;
#[cfg(test)]
pub(crate) mod tests;
mod triangles;

#[doc(hidden)]
pub use bodies::BodyChange;
pub(crate) use bodies::Carrier;
pub use candidates::{ContactPoint, NarrowPhase};
#[doc(hidden)]
pub use candidates::{ContactSettings, PARTICLES_FROM, Touch};
pub(crate) use colliders::SkinnedTriangles;
#[doc(hidden)]
pub use colliders::{BodyMass, MovingCollider};
pub use colliders::{
    ClothCollider, ClothLayers, ColliderGeometry, ColliderShape, DeformingMesh, MeshCollider,
    SharedCollider,
};
#[doc(hidden)]
pub use detection::Detection;
pub use layers::ClothSelfCollision;
#[doc(hidden)]
pub use layers::intersections;
pub(crate) use layers::{Inside, MutualContact, Participant, Sheet};
#[doc(hidden)]
pub use particles::deepest_penetration;
#[doc(hidden)]
pub use triangles::meets_triangles;
