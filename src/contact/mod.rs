//! Floor 2: contact: collider shapes, swept tests, push-out, friction, penetration depth and area.

mod body;
mod boxes;
mod candidates;
mod carriers;
mod cells;
mod collider;
mod corners;
mod depth;
mod detection;
mod edge_contact;
mod edge_room;
mod eight;
mod embedded;
mod faces;
mod fan_view;
mod friction;
mod geometry;
mod guard;
mod held;
mod kept;
mod lanes;
mod layers;
mod mass;
mod moving;
mod mutual;
mod narrow_phase;
mod nearest;
mod particle;
mod planes;
mod pushing;
mod response;
mod shape;
mod shape_cache;
mod shape_memory;
mod sharp;
mod source;
#[cfg(test)]
mod tests;
mod touch;
mod triangle;

#[doc(hidden)]
pub use body::BodyChange;
pub(crate) use carriers::Carrier;
pub use collider::{ClothCollider, MeshCollider};
#[doc(hidden)]
pub use corners::meets_triangles;
#[doc(hidden)]
pub use depth::deepest_penetration;
#[doc(hidden)]
pub use detection::Detection;
pub use geometry::ColliderGeometry;
pub use layers::ClothLayers;
#[doc(hidden)]
pub use mass::BodyMass;
#[doc(hidden)]
pub use moving::MovingCollider;
pub use mutual::ClothSelfCollision;
#[doc(hidden)]
pub use mutual::intersections;
pub(crate) use mutual::{Inside, MutualContact, Participant, Sheet};
pub use narrow_phase::NarrowPhase;
#[doc(hidden)]
pub use narrow_phase::PARTICLES_FROM;
pub use shape::ColliderShape;
pub use source::SharedCollider;
pub use touch::ContactPoint;
#[doc(hidden)]
pub use touch::{ContactSettings, Touch};
