//! A spring.

use bevy::reflect::Reflect;

/// The deformation that a spring resists.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
pub enum SpringKind {
    /// Stretch: neighbours in a row or column.
    Structural,
    /// Shear: neighbours along a diagonal.
    Shear,
    /// Bending, only in the game's own lists: a cloth's own bending uses no springs. On a mesh, shear across an edge.
    Bend,
}

/// A spring between two particles.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
pub struct Spring {
    /// The deformation that it resists.
    pub kind: SpringKind,
    /// Indices of its two particles.
    pub ends: [u32; 2],
    /// Length at which the spring exerts no force (m), positive.
    pub rest_length: f32,
    /// Elongation per newton (m/N); 0 is rigid.
    pub compliance: f32,
}
