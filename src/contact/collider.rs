//! What a cloth can touch.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::components::Transform,
};

use crate::cloth::ClothError;

/// Something that every cloth collides with, at the entity's [`Transform`]. It moves however the game moves
/// it; the cloth never pushes it back.
///
/// Its speed, and with it its friction, comes from how the transform changed since the last tick: move it in
/// the cloth's schedule, before [`ClothSystems::Prepare`](crate::plugin::ClothSystems). To move it without any
/// speed, a teleport, insert this component anew.
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

    /// The ball's radius under a transform's `scale` (m): a ball stays one, so the largest axis counts.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for a radius that is zero, negative or not finite, scaled or not.
    pub fn scaled_radius(&self, scale: Vec3) -> Result<f32, ClothError> {
        let Self::Ball { radius } = *self;
        let positive = |v: f32| v > 0.0 && v.is_finite();
        ClothError::check(radius, positive, "the ball's radius (m)", "positive")?;
        let scaled = radius * scale.abs().max_element();
        ClothError::check(scaled, positive, "the ball's scaled radius (m)", "positive")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_radius_is_scaled_and_checked() {
        assert_eq!(ClothCollider::default().scaled_radius(Vec3::ONE), Ok(1.0));
        assert_eq!(
            ClothCollider::ball(0.5).scaled_radius(Vec3::new(1.0, -3.0, 2.0)),
            Ok(1.5)
        );
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(
                ClothCollider::ball(radius)
                    .scaled_radius(Vec3::ONE)
                    .is_err(),
                "{radius}"
            );
        }
        assert!(ClothCollider::ball(1.0).scaled_radius(Vec3::ZERO).is_err());
        assert!(
            ClothCollider::ball(1.0)
                .scaled_radius(Vec3::INFINITY)
                .is_err()
        );
    }
}
