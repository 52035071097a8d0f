//! Errors of entities that others name.

use bevy::{ecs::entity::Entity, reflect::Reflect};
use thiserror::Error;

/// The reason why an entity can't be the target of another.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TargetError {
    /// The cloth that drives a mesh, or that a hand holds, does not exist, or is not a cloth.
    #[error("{cloth} does not exist or is not a cloth")]
    NoSuchCloth {
        /// The missing cloth.
        cloth: Entity,
    },
    /// A hand has a parent, or is the cloth that it holds.
    #[error("a `ClothGrab` must be on an entity of its own, without a parent")]
    HandNotAlone,
    /// A character has no descendant with the name of the bone.
    #[error("no descendant of this entity is a bone named \"{name}\"")]
    NoSuchBone {
        /// The name of the bone.
        name: String,
    },
    /// The target of an attached pin does not exist or has no transform.
    #[error("{pin} is attached to {target}, which does not exist or has no transform")]
    NoTarget {
        /// The attached pin.
        pin: String,
        /// The target.
        target: Entity,
    },
    /// No entity has the name of an attached pin's target.
    #[error("{pin} is attached to \"{name}\", but no entity with a transform has that name")]
    NoTargetNamed {
        /// The attached pin.
        pin: String,
        /// The name of the target.
        name: String,
    },
}
