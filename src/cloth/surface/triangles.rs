//! What a surface that is no grid is made from.

use bevy::math::{Vec2, Vec3};

/// The triangles that a surface is made from.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct TriangleMesh {
    /// Vertices (m), before the transform's scale.
    pub positions: Vec<Vec3>,
    /// Three vertices each, in either order.
    pub triangles: Vec<[u32; 3]>,
    /// Normals of the vertices: they say which side is the front. May be empty.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of the vertices. May be empty.
    pub uvs: Vec<Vec2>,
    /// What else the vertices carry, for pins to ask for.
    pub attributes: Vec<VertexAttribute>,
}

/// Numbers that the vertices of a mesh carry, and then the particles of a cloth: for a particle of several vertices the
/// largest of theirs.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexAttribute {
    name: String,
    values: Vec<[f32; 4]>,
}

impl VertexAttribute {
    /// With up to four channels for each vertex; those that it does not have are 0.
    pub fn new(name: impl Into<String>, values: Vec<[f32; 4]>) -> Self {
        Self {
            name: name.into(),
            values,
        }
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What some are called, for a message.
    pub(crate) fn names(attributes: &[Self]) -> String {
        let names: Vec<&str> = attributes.iter().map(Self::name).collect();
        if names.is_empty() {
            "none".to_string()
        } else {
            names.join(", ")
        }
    }

    /// Four numbers for each.
    pub fn values(&self) -> &[[f32; 4]] {
        &self.values
    }
}

/// The joints that move a vertex, and by how much each.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct JointWeights {
    pub joints: [u16; 4],
    pub weights: [f32; 4],
}
