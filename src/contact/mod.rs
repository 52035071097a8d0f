//! Floor 2: what happens on *touch*: collider shapes, swept tests, push-out, friction, how deep and how much.

mod body;
mod candidates;
mod cells;
mod collider;
mod corners;
mod depth;
mod detection;
mod eight;
mod faces;
mod friction;
mod held;
mod kept;
mod lanes;
mod layers;
mod mass;
mod moving;
mod mutual;
mod narrow_phase;
mod particle;
mod response;
mod shape;
#[cfg(test)]
mod tests;
mod touch;
mod triangle;

pub use body::BodyChange;
pub use collider::ClothCollider;
pub use corners::meets_triangles;
#[doc(hidden)]
pub use depth::deepest_penetration;
pub use detection::Detection;
pub use layers::ClothLayers;
pub use mass::BodyMass;
pub use moving::MovingCollider;
pub use mutual::{ClothSelfCollision, intersections};
pub(crate) use mutual::{MutualContact, Participant, Sheet};
pub use narrow_phase::{NarrowPhase, PARTICLES_FROM};
pub use shape::ColliderShape;
pub use touch::{ContactPoint, ContactSettings, Touch};
