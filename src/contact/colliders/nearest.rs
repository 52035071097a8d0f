//! The nearest point of a shape.

use bevy::math::{Quat, Vec3};

/// A point relative to a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nearest {
    /// Distance from the surface (m), negative inside.
    pub distance: f32,
    /// Direction away from the shape, of length 1.
    pub normal: Vec3,
}

impl Nearest {
    /// The same in a frame that is turned.
    #[inline]
    pub fn turned(self, rotation: Quat) -> Self {
        Self {
            normal: rotation * self.normal,
            ..self
        }
    }
}
