//! A spring.

use bevy::reflect::Reflect;

/// What a spring resists.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SpringKind {
    /// Stretch: neighbours in a row or column.
    Structural,
    /// Shear: neighbours along a diagonal.
    Shear,
    /// Bending, in lists of the game's own: a cloth's bending is no matter of springs. On a mesh, shear across an edge.
    Bend,
}

/// A spring between two particles.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// What it resists.
    pub kind: SpringKind,
    /// Indices of its two particles.
    pub ends: [u32; 2],
    /// Length without a force (m), positive.
    pub rest_length: f32,
    /// How far a newton stretches it (m/N); 0 is rigid.
    pub compliance: f32,
}
