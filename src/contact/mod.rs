//! Floor 2: what happens on *touch*: collider shapes, swept tests, push-out, friction, how deep and how much.

mod collider;
mod depth;
mod detection;
mod moving;
mod particle;
mod response;
mod shape;
mod surface;
#[cfg(test)]
mod tests;
mod triangle;

pub use collider::ClothCollider;
pub use depth::deepest_penetration;
pub use detection::{ContactPoint, Detection, Terms, Touch};
pub use moving::MovingCollider;
pub use shape::ColliderShape;
pub use surface::{NarrowPhase, PARTICLES_FROM, meets_triangles};
