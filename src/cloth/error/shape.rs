//! Errors of shapes of colliders.

use bevy::{math::Vec3, reflect::Reflect};
use thiserror::Error;

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
