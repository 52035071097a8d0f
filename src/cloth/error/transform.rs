//! Errors of transforms.

use bevy::{ecs::entity::Entity, reflect::Reflect};
use thiserror::Error;

/// The reason why an entity has no usable place.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TransformError {
    /// An entity, or one of its ancestors, has no `Transform`.
    #[error("{name} has no `Transform`: insert one, such as `Transform::default()`")]
    Missing {
        /// The entity without one.
        entity: Entity,
        /// Its `Name` or ID, after `the parent` or `the ancestor` where it is above.
        name: String,
    },
    /// A transform is not finite, or has a zero scale.
    #[error("the global transform must be finite, with a scale other than zero: {transform}")]
    Unusable {
        /// The transform, as text.
        transform: String,
    },
}
