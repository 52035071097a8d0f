//! Ropes from the edges of a mesh.

use bevy::{
    math::Vec3,
    mesh::{Mesh, PrimitiveTopology},
};
use thiserror::Error;

use super::{
    error::ClothError,
    surface::{indices, positions},
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
    /// Its edges do not lead from one end to the other.
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
    Mesh(#[from] ClothError),
}

/// The places along the edges of a mesh of lines, from the end with the lower index.
///
/// # Errors
/// Those of [`RopeError`].
pub(super) fn path_of(mesh: &Mesh) -> Result<Vec<Vec3>, RopeError> {
    let positions = positions(mesh)?;
    let indices = indices(mesh, positions.len())?;
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
            return Err(RopeError::Topology {
                topology: format!("{topology:?}"),
            });
        }
    };
    let mut beside = vec![Vec::new(); positions.len()];
    for [a, b] in edges {
        for (end, other) in [(a, b), (b, a)] {
            let vertex = end as usize;
            (beside.get_mut(vertex))
                .ok_or(RopeError::NotAChain { vertex, edges: 0 })?
                .push(other);
        }
    }
    let refused = |vertex: usize| RopeError::NotAChain {
        vertex,
        edges: beside.get(vertex).map_or(0, Vec::len),
    };
    if let Some(vertex) = beside
        .iter()
        .position(|others| !(1..=2).contains(&others.len()))
    {
        return Err(refused(vertex));
    }
    let first = beside.iter().position(|others| others.len() == 1);
    let mut path = vec![first.ok_or_else(|| refused(0))?];
    while let Some(next) = beside[path[path.len() - 1]]
        .iter()
        .map(|other| *other as usize)
        .find(|other| path.len() < 2 || *other != path[path.len() - 2])
    {
        path.push(next);
    }
    if path.len() < positions.len() {
        let mut is_reached = vec![false; positions.len()];
        path.iter().for_each(|vertex| is_reached[*vertex] = true);
        return Err(refused(is_reached.iter().position(|is| !is).unwrap_or(0)));
    }
    Ok(path.into_iter().map(|vertex| positions[vertex]).collect())
}
