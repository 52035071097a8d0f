//! What a cloth can touch.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::components::Transform,
};

use super::ColliderShape;
use crate::cloth::ClothError;

/// Something that every cloth collides with, at the entity's [`Transform`]. It moves however the game moves
/// it; the cloth never pushes it back.
///
/// Its speed, and with it its friction, comes from how the transform changed since the last tick: move it in
/// the cloth's schedule, before [`ClothSystems::Prepare`](crate::plugin::ClothSystems). To move it without any
/// speed, a teleport, insert this component again.
///
/// However fast it is: what moves farther in a sub-step than half of its thickness is tested all along its way, so that
/// nothing that a ball or a capsule meets passes through it, nor any particle that a box or a plane meets.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
#[non_exhaustive]
pub enum ClothCollider {
    /// A ball.
    Ball {
        /// Radius (m), before the transform's scale.
        radius: f32,
    },
    /// A capsule along the entity's y axis, as Bevy's `Capsule3d`.
    Capsule {
        /// Radius (m), before the transform's scale.
        radius: f32,
        /// Half of the length between the centres of its two half-balls (m), likewise.
        half_length: f32,
    },
    /// A box, as Bevy's `Cuboid`. Cloth touches it with its particles alone: its corners may show between them.
    Cuboid {
        /// Half of its lengths (m), before the transform's scale.
        half_size: Vec3,
    },
    /// All below a plane, whose normal is the entity's y axis.
    Plane,
}

impl Default for ClothCollider {
    /// The paper's ball, of radius 1.
    fn default() -> Self {
        Self::ball(1.0)
    }
}

impl ClothCollider {
    /// A ball of `radius` (m).
    pub const fn ball(radius: f32) -> Self {
        Self::Ball { radius }
    }

    /// A capsule of `radius`, with so much between the centres of its two half-balls (m).
    pub const fn capsule(radius: f32, length: f32) -> Self {
        Self::Capsule {
            radius,
            half_length: length / 2.0,
        }
    }

    /// A box of these lengths (m).
    pub const fn cuboid(x: f32, y: f32, z: f32) -> Self {
        Self::Cuboid {
            half_size: Vec3::new(x / 2.0, y / 2.0, z / 2.0),
        }
    }

    /// All below the entity's xz plane.
    pub const fn plane() -> Self {
        Self::Plane
    }

    /// The shape under a transform's `scale`: a ball stays one, so the largest axis counts, and so it does across a
    /// capsule.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for a length that is zero, negative or not finite, scaled or not. A capsule's may be
    /// zero.
    pub fn scaled(&self, scale: Vec3) -> Result<ColliderShape, ClothError> {
        let positive = |v: f32| v > 0.0 && v.is_finite();
        let length = |value: f32, scale: f32, quantity, scaled_quantity| {
            ClothError::check(value, positive, quantity, "positive")?;
            ClothError::check(value * scale, positive, scaled_quantity, "positive")
        };
        let scale = scale.abs();
        match *self {
            Self::Ball { radius } => {
                let largest = scale.max_element();
                let radius = length(
                    radius,
                    largest,
                    "the ball's radius (m)",
                    "the ball's scaled radius (m)",
                )?;
                Ok(ColliderShape::Ball { radius })
            }
            Self::Capsule {
                radius,
                half_length,
            } => {
                let across = scale.x.max(scale.z);
                let radius = length(
                    radius,
                    across,
                    "the capsule's radius (m)",
                    "the capsule's scaled radius (m)",
                )?;
                let not_negative = |v: f32| v >= 0.0 && v.is_finite();
                let half_length = ClothError::check(
                    half_length * scale.y,
                    not_negative,
                    "half of the capsule's scaled length (m)",
                    "zero or more",
                )?;
                Ok(ColliderShape::Capsule {
                    radius,
                    half_length,
                })
            }
            Self::Cuboid { half_size } => {
                for (value, scale) in half_size.to_array().into_iter().zip(scale.to_array()) {
                    length(
                        value,
                        scale,
                        "half of the box's length (m)",
                        "half of the box's scaled length (m)",
                    )?;
                }
                Ok(ColliderShape::Cuboid {
                    half_size: half_size * scale,
                })
            }
            Self::Plane => Ok(ColliderShape::HalfSpace),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_scaled() {
        let scale = Vec3::new(1.0, -3.0, 2.0);
        let scaled = |collider: ClothCollider| collider.scaled(scale).expect("a valid collider");
        assert_eq!(
            scaled(ClothCollider::default()),
            ColliderShape::Ball { radius: 3.0 }
        );
        assert_eq!(
            scaled(ClothCollider::capsule(0.5, 2.0)),
            ColliderShape::Capsule {
                radius: 1.0,
                half_length: 3.0
            }
        );
        assert_eq!(
            scaled(ClothCollider::cuboid(2.0, 4.0, 6.0)),
            ColliderShape::Cuboid {
                half_size: Vec3::new(1.0, 6.0, 6.0)
            }
        );
        assert_eq!(scaled(ClothCollider::plane()), ColliderShape::HalfSpace);
    }

    #[test]
    fn lengths_are_checked() {
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            for collider in [
                ClothCollider::ball(bad),
                ClothCollider::capsule(bad, 1.0),
                ClothCollider::cuboid(1.0, bad, 1.0),
            ] {
                assert!(collider.scaled(Vec3::ONE).is_err(), "{collider:?}");
            }
            let short = ClothCollider::capsule(1.0, bad).scaled(Vec3::ONE);
            assert_eq!(short.is_ok(), bad == 0.0, "{bad}");
        }
        for scale in [Vec3::ZERO, Vec3::INFINITY, Vec3::NAN] {
            for collider in [
                ClothCollider::ball(1.0),
                ClothCollider::capsule(1.0, 1.0),
                ClothCollider::cuboid(1.0, 1.0, 1.0),
            ] {
                assert!(collider.scaled(scale).is_err(), "{collider:?} {scale}");
            }
        }
    }
}
