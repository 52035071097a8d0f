//! Floor 2: what happens on *touch*: collider shapes, swept tests, push-out, friction, how deep and how much.

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
mod edge_memory;
mod edge_room;
mod eight;
mod faces;
mod fan_view;
mod friction;
mod geometry;
mod geometry_particles;
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
mod pushing;
mod response;
mod shape;
mod shape_cache;
mod sharp;
mod source;
#[cfg(test)]
mod tests;
mod touch;
mod triangle;

pub use body::BodyChange;
pub(crate) use carriers::Carrier;
pub use collider::{ClothCollider, MeshCollider};
pub use corners::meets_triangles;
#[doc(hidden)]
pub use depth::deepest_penetration;
pub use detection::Detection;
pub use geometry::ColliderGeometry;
pub use layers::ClothLayers;
pub use mass::BodyMass;
pub use moving::MovingCollider;
pub use mutual::{ClothSelfCollision, intersections};
pub(crate) use mutual::{Inside, MutualContact, Participant, Sheet};
pub use narrow_phase::{NarrowPhase, PARTICLES_FROM};
pub use shape::ColliderShape;
pub use source::SharedCollider;
pub use touch::{ContactPoint, ContactSettings, Touch};
