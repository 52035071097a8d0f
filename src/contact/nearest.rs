//! How a point lies to a shape.

use bevy::math::Vec3;

/// How a point lies to a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::contact) struct Nearest {
    /// Distance from the surface (m), negative inside.
    pub distance: f32,
    /// Away from the shape, of length 1.
    pub normal: Vec3,
}
