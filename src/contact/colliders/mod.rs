//! Colliders: their shapes, the nearest points and sharp edges of these, and their motion in a sub-step.

mod boxes;
mod collider;
mod collision_layers;
mod deforming;
mod geometry;
mod manifold;
mod mass;
mod moving;
mod nearest;
mod primitives;
mod shape;
mod source;
mod triangle;

pub use collider::{ClothCollider, MeshCollider};
pub use collision_layers::ClothLayers;
pub use deforming::DeformingMesh;
pub(crate) use deforming::SkinnedTriangles;
#[cfg(all(test, feature = "mesh"))]
pub(crate) use deforming::Topology;
pub use geometry::ColliderGeometry;
pub(crate) use geometry::SharpEdge;
pub(crate) use manifold::{MOST_POINTS, Manifold, ManifoldPoint};
pub use mass::BodyMass;
pub use moving::MovingCollider;
pub(crate) use moving::{ColliderSubstep, moving_of, swing};
pub(crate) use nearest::Nearest;
pub use shape::ColliderShape;
pub use source::SharedCollider;
#[cfg(test)]
pub(crate) use triangle::area_within;
pub(crate) use triangle::{NearestPoints, at, cap, nearest, nearest_of_segments, nearest_to_point};
