//! Pins: selections of particles to pin.

use bevy::{
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::function::define_function;

/// A corner of the cloth at rest, seen from its front: +z, or +y for a lying cloth.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum Corner {
    /// (0, 0).
    #[default]
    TopLeft,
    /// (0, columns − 1).
    TopRight,
    /// (rows − 1, 0).
    BottomLeft,
    /// (rows − 1, columns − 1).
    BottomRight,
}

/// A selection of particles to pin.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Pin {
    /// The particle with this index.
    Index(usize),
    /// The particle at (row, column).
    Cell(u32, u32),
    /// A whole row, 0 at the top.
    Row(u32),
    /// A whole column, 0 at the left.
    Column(u32),
    /// One corner.
    Corner(Corner),
    /// Every particle whose (row, column) passes the predicate. Closures cannot be serialized: loaded from a scene
    /// file, it pins nothing.
    Where(#[reflect(ignore)] PinPredicate),
    /// The default: the top row of a grid, the first particle of a rope, and nothing of a mesh.
    #[default]
    Top,
    /// The particle of a mesh vertex, by the vertex index in the asset or in
    /// [`Cloth::triangles`](crate::cloth::Cloth::triangles). Welding does not change these indices.
    Vertex(usize),
    /// Every particle within a radius of a point at rest.
    Near {
        /// The point in the entity's frame (m), before the transform's scale, like a mesh's vertices.
        point: Vec3,
        /// The radius (m), before the transform's scale.
        radius: f32,
    },
    /// Every particle whose position at rest passes the predicate. Closures cannot be serialized: loaded from a scene
    /// file, it pins nothing.
    AtRest(#[reflect(ignore)] RestPredicate),
    /// Every particle with a vertex whose attribute exceeds a value, such as an artist's paint.
    Attribute {
        /// The name of the attribute: `Vertex_Color`, or that of a custom one registered with `GltfPlugin`.
        name: String,
        /// The channel, from 0.
        channel: usize,
        /// The value to exceed.
        above: f32,
    },
}

define_function! {
    /// A predicate of (row, column). The default pins none.
    PinPredicate,
    /// Pins every particle for which `holds(row, column)` returns true.
    holds(row: u32, column: u32) -> bool, false
}

define_function! {
    /// A predicate of a particle's position at rest, in the entity's frame (m), before the transform's scale. The default
    /// pins none.
    RestPredicate,
    /// Pins every particle for which `holds(position at rest)` returns true.
    holds(place: Vec3) -> bool, false
}

impl Pin {
    /// Pins every particle for which `holds(row, column)` returns true.
    pub fn filter(holds: impl Fn(u32, u32) -> bool + Send + Sync + 'static) -> Self {
        Self::Where(PinPredicate::new(holds))
    }

    /// Pins every particle for whose position at rest `holds` returns true. The position is in the entity's frame (m),
    /// before the transform's scale.
    pub fn at_rest(holds: impl Fn(Vec3) -> bool + Send + Sync + 'static) -> Self {
        Self::AtRest(RestPredicate::new(holds))
    }

    /// Pins every particle with a vertex whose colour exceeds a value in a channel: 0 for red, 3 for alpha.
    pub fn color(channel: usize, above: f32) -> Self {
        Self::attribute("Vertex_Color", channel, above)
    }

    /// Pins every particle with a vertex whose attribute exceeds a value in a channel, from 0.
    pub fn attribute(name: impl Into<String>, channel: usize, above: f32) -> Self {
        Self::Attribute {
            name: name.into(),
            channel,
            above,
        }
    }
}
