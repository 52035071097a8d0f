//! Errors that modules of upper floors raise.

use bevy::{ecs::entity::Entity, math::Vec3, reflect::Reflect};
use thiserror::Error;

/// The reason why a bounding volume is not used.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum BoundsError {
    /// A bounding volume does not support the bound rule.
    #[error(
        "{volume} do not support the bound rule `{rule}`: use `BoundRule::Refit`, or spheres or AABBs"
    )]
    Unsupported {
        /// The bounding volumes, in the plural.
        #[reflect(ignore)]
        volume: &'static str,
        /// The rule.
        #[reflect(ignore)]
        rule: &'static str,
    },
}

/// The reason why a cloth can't touch itself.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SelfCollisionError {
    /// A cloth's thickness is more than half of its shortest spacing.
    #[error(
        "a thickness of {thickness} m needs a spacing of at least twice that, but the shortest is {shortest} m: use a smaller thickness or fewer particles"
    )]
    TooThick {
        /// The thickness (m).
        thickness: f32,
        /// The shortest spacing at rest (m).
        shortest: f32,
    },
}

/// The reason why cloth can't collide with a shape.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ShapeError {
    /// A shape that cloth cannot touch, such as a line.
    #[error("cloth cannot collide with this shape: {shape}")]
    NoSuchShape {
        /// The shape.
        shape: String,
    },
    /// The points of a convex hull lie in one plane.
    #[error("the convex hull of these {points} points has no volume: they lie in one plane")]
    FlatHull {
        /// Number of points.
        points: usize,
    },
    /// A height field has fewer than two rows or columns, or an incomplete row.
    #[error(
        "a height field needs at least 2 full rows of at least 2 columns, not {heights} heights in {columns} columns"
    )]
    HeightFieldSize {
        /// Number of heights.
        heights: usize,
        /// Number of heights in each row.
        columns: usize,
    },
    /// A compound has a rotated part and a scale that is not uniform.
    #[error("a compound with a rotated part needs a uniform scale, not {scale}")]
    SkewedPart {
        /// The scale of the transform.
        scale: Vec3,
    },
    /// A part of a compound has a position that is out of range, or a rotation that cannot be normalized.
    #[error(
        "part {part} of the compound needs a finite position within 10¹² m and a rotation other than zero: position {place}, rotation {rotation}"
    )]
    PartPose {
        /// Index of the part.
        part: usize,
        /// Its position (m).
        place: Vec3,
        /// Its rotation, as text.
        rotation: String,
    },
}

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
