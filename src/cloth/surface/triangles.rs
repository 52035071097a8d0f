//! Triangles to make a surface from.

use bevy::math::{Vec2, Vec3};

/// Triangles to make a [`Surface`](crate::cloth::Surface) from.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct TriangleMesh {
    /// Positions of the vertices (m), before the transform's scale.
    pub positions: Vec<Vec3>,
    /// Three vertices each, in either winding order.
    pub triangles: Vec<[u32; 3]>,
    /// Normals of the vertices, which define the front. May be empty.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of the vertices. May be empty.
    pub uvs: Vec<Vec2>,
    /// Further vertex attributes, for pins and paint.
    pub attributes: Vec<VertexAttribute>,
}

/// A vertex attribute of a mesh, converted to the particles of a cloth: a particle of several vertices takes their
/// largest value.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexAttribute {
    name: String,
    values: Vec<[f32; 4]>,
}

impl VertexAttribute {
    /// An attribute with up to four channels for each vertex; unused channels are 0.
    pub fn new(name: impl Into<String>, values: Vec<[f32; 4]>) -> Self {
        Self {
            name: name.into(),
            values,
        }
    }

    /// The name of the attribute.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The names of attributes, for a message.
    pub(crate) fn names(attributes: &[Self]) -> String {
        let names: Vec<&str> = attributes.iter().map(Self::name).collect();
        if names.is_empty() {
            "none".to_string()
        } else {
            names.join(", ")
        }
    }

    /// Four values for each vertex.
    pub fn values(&self) -> &[[f32; 4]] {
        &self.values
    }
}

/// The joints that move a vertex, and their weights.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct JointWeights {
    pub joints: [u16; 4],
    pub weights: [f32; 4],
}
