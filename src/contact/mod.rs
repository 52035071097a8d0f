//! Floor 2: what happens on *touch*: collider shapes, push-out, friction.

mod ball;
mod collider;

pub use ball::{MovingBall, deepest_penetration, push_out};
pub use collider::ClothCollider;
