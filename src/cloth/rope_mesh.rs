//! Ropes from the edges of a mesh.

use bevy::{
    math::Vec3,
    mesh::{Mesh, PrimitiveTopology},
};
use thiserror::Error;

use super::{
    lines::edge_lines,
    surface::{MeshError, indices_of_asset, positions_of_asset},
};

/// The reason why [`Cloth::rope_of`](crate::cloth::Cloth::rope_of) makes no rope of a mesh.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RopeError {
    /// The mesh is not made of lines.
    #[error("a rope needs a list or a strip of lines, not a {topology}")]
    Topology {
        /// The topology of the mesh.
        topology: String,
    },
    /// A list of lines lists an index too many.
    #[error("a list of lines needs an even number of indices, not {indices}")]
    Unpaired {
        /// Number of indices.
        indices: usize,
    },
    /// A line ends at a vertex that does not exist.
    #[error("a line ends at vertex {vertex}, but the mesh has {vertices}")]
    NoSuchVertex {
        /// The vertex.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// Its edges do not lead from one end to the other. Vertices in one place are not joined: each edge has to share its vertices with the next.
    #[error(
        "the edges of a rope must lead from one end to the other, but vertex {vertex} has {edges} of them"
    )]
    NotAChain {
        /// The first vertex that is in the way, or is not reached.
        vertex: usize,
        /// Edges that end at it.
        edges: usize,
    },
    /// The mesh can't be read, or has no positions.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// The places along the edges of a mesh of lines, from the end with the lower index.
///
/// # Errors
/// Those of [`RopeError`].
pub(super) fn path_of(mesh: &Mesh) -> Result<Vec<Vec3>, RopeError> {
    let positions = positions_of_asset(mesh)?;
    let indices = indices_of_asset(mesh, positions.len())?;
    let edges: Vec<[u32; 2]> = match mesh.primitive_topology() {
        PrimitiveTopology::LineList => match indices.as_chunks() {
            (edges, []) => edges.to_vec(),
            _ => {
                let indices = indices.len();
                return Err(RopeError::Unpaired { indices });
            }
        },
        PrimitiveTopology::LineStrip => indices.array_windows().copied().collect(),
        topology => {
            let topology = format!("{topology:?}");
            return Err(RopeError::Topology { topology });
        }
    };
    let vertices = positions.len();
    let mut beside = vec![Vec::new(); vertices];
    for [a, b] in edges.into_iter().map(|edge| edge.map(|end| end as usize)) {
        let vertex = a.max(b);
        if vertex >= vertices {
            return Err(RopeError::NoSuchVertex { vertex, vertices });
        }
        beside[a].push(b);
        beside[b].push(a);
    }
    let lines = edge_lines(&mut beside, |vertex| vertex);
    let is_inside = |others: &Vec<usize>| (1..=2).contains(&others.len());
    let wrong = beside.iter().position(|others| !is_inside(others));
    // A ring begins anywhere, and begins with two edges. A second line begins at a vertex that the first does not reach.
    let wrong = wrong.or_else(|| match &lines[..] {
        [line] if beside[line.places[0]].len() == 1 => None,
        [line] => Some(line.places[0]),
        [_, second, ..] => Some(second.places[0]),
        [] => None,
    });
    if let Some(vertex) = wrong {
        let edges = beside[vertex].len();
        return Err(RopeError::NotAChain { vertex, edges });
    }
    let along = lines.into_iter().flat_map(|line| line.places);
    Ok(along.map(|vertex| positions[vertex]).collect())
}
