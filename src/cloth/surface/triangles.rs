//! Triangles to make a surface from.

use bevy::{
    math::{Vec2, Vec3},
    reflect::Reflect,
};
use thiserror::Error;

use crate::cloth::{limits::FARTHEST, quantity::QuantityError};

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

/// The reason why a mesh makes no cloth and no collider.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// The mesh asset of a cloth does not exist, and is not being loaded.
    #[error("the mesh is neither loaded nor loading: does the entity have a `Mesh3d`?")]
    NotLoaded,
    /// The mesh asset of a cloth is being loaded: the cloth waits for it. Neither logged nor marked.
    #[error("the mesh is being loaded")]
    Loading,
    /// The mesh asset of a cloth could not be loaded.
    #[error("the mesh could not be loaded: {reason}")]
    Failed {
        /// The error of the asset server.
        reason: String,
    },
    /// A mesh has its vertices only in the render world.
    #[error(
        "the mesh is only in the render world: load it with `RenderAssetUsages::MAIN_WORLD` too, which is the default"
    )]
    NotReadable,
    /// A mesh is made of lines or points.
    #[error("a cloth needs a triangle list or a triangle strip, not a {topology}")]
    Topology {
        /// The topology of the mesh.
        topology: String,
    },
    /// A mesh has no positions, or positions that are not `Float32x3`.
    #[error("the mesh has no positions of format `Float32x3`")]
    WithoutPositions,
    /// The number of indices is not a multiple of three.
    #[error("{indices} indices do not make whole triangles: their number must be a multiple of 3")]
    IndexCount {
        /// Number of indices.
        indices: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} has corners {corners:?}, but there are {vertices} vertices")]
    TriangleOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
        /// Number of vertices.
        vertices: usize,
    },
    /// A vertex is not finite, or beyond 10¹² m.
    #[error("vertex {vertex} is not finite or is beyond 10¹² m: {position}")]
    VertexNotFinite {
        /// Index of the vertex.
        vertex: usize,
        /// Its position (m).
        position: Vec3,
    },
    /// No triangle of the mesh has an area.
    #[error("none of the mesh's {triangles} triangles has an area")]
    WithoutArea {
        /// Number of triangles.
        triangles: usize,
    },
    /// A mesh gives more particles than [`MAX_MESH_PARTICLES`](crate::cloth::MAX_MESH_PARTICLES).
    #[error("{particles} particles exceed the maximum of 262144 for a cloth from a mesh")]
    TooLarge {
        /// Number of particles that the mesh gives.
        particles: usize,
    },
    /// A cloth with pressure does not enclose a volume.
    #[error(
        "a cloth with pressure must be a closed mesh, with two faces at each edge, but this mesh has a border"
    )]
    NotClosed,
    /// A mesh driven by a cloth is too far from it.
    #[error(
        "vertex {vertex} of the mesh is {distance} m from the cloth at rest, which is only {farthest} m across: place the mesh on the cloth"
    )]
    BoundTooFar {
        /// Index of the vertex.
        vertex: usize,
        /// Its distance from the cloth (m).
        distance: f32,
        /// The largest allowed distance (m).
        farthest: f32,
    },
    /// The distance of welding is out of range.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
}

impl MeshError {
    /// Checks that all vertices are finite and in range under a scale.
    ///
    /// # Errors
    /// [`MeshError::VertexNotFinite`] for the first that is not.
    pub(crate) fn check_vertices(vertices: &[Vec3], scale: Vec3) -> Result<(), Self> {
        // Not by the largest element, which ignores NaN.
        let is_far = |place: &Vec3| !(*place * scale).abs().cmplt(Vec3::splat(FARTHEST)).all();
        vertices.iter().position(is_far).map_or(Ok(()), |vertex| {
            let position = vertices[vertex];
            Err(Self::VertexNotFinite { vertex, position })
        })
    }

    /// Checks that all triangles are of that many vertices.
    ///
    /// # Errors
    /// [`MeshError::TriangleOutOfRange`] for the first that is not.
    pub(crate) fn check_triangles(triangles: &[[u32; 3]], vertices: usize) -> Result<(), Self> {
        let is_beyond = |corners: &[u32; 3]| corners.iter().any(|at| *at as usize >= vertices);
        let beyond = triangles.iter().position(is_beyond);
        beyond.map_or(Ok(()), |triangle| {
            Err(Self::TriangleOutOfRange {
                triangle,
                corners: triangles[triangle],
                vertices,
            })
        })
    }
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
        match &names[..] {
            [] => "none".to_string(),
            names => names.join(", "),
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

impl JointWeights {
    /// The joints with a weight, and those.
    #[inline]
    pub fn moving(&self) -> impl Iterator<Item = (usize, f32)> {
        let each = self.joints.into_iter().zip(self.weights);
        each.filter(|(_, weight)| *weight > 0.0)
            .map(|(joint, weight)| (usize::from(joint), weight))
    }
}
