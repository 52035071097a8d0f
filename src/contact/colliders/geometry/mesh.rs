//! Builds a mesh from positions and triangles: welded, oriented and with its edges.

use bevy::math::{DVec3, Vec3};
use parry3d::shape::{TriMesh, TriMeshFlags};

use super::{
    edges::{MeshEdges, SharpEdge},
    solid::MeshSides,
};
use crate::cloth::MeshError;

/// Positions of vertices (m), and those of each triangle.
pub(crate) type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

/// A mesh, its inside, and its sharp edges.
pub(crate) type Built = (TriMesh, MeshSides, Vec<SharpEdge>);

/// Checks that all triangles are of these vertices, and that one of them has an area.
///
/// # Errors
/// For a vertex that is not finite or missing, and if no triangle has an area.
pub(in crate::contact::colliders) fn check_triangles(
    vertices: &[Vec3],
    triangles: &[[u32; 3]],
) -> Result<(), MeshError> {
    MeshError::check_vertices(vertices, Vec3::ONE)?;
    MeshError::check_triangles(triangles, vertices.len())?;
    let areas = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|corner| vertices[corner as usize]);
        (b - a).cross(c - a).length()
    });
    if areas.sum::<f32>() <= 0.0 {
        return Err(MeshError::WithoutArea {
            triangles: triangles.len(),
        });
    }
    Ok(())
}

/// A mesh of triangles, solid if it is closed. An inside-out mesh is flipped.
///
/// # Errors
/// For a vertex that is not finite or missing, and if no triangle has an area.
pub(crate) fn build(
    (mut vertices, triangles): Triangles,
    ground: bool,
) -> Result<Built, MeshError> {
    let count = triangles.len();
    check_triangles(&vertices, &triangles)?;
    // Merges equal vertices: −0 equals 0.
    vertices.iter_mut().for_each(|vertex| *vertex += Vec3::ZERO);
    let welded = TriMeshFlags::MERGE_DUPLICATE_VERTICES
        | TriMeshFlags::DELETE_DEGENERATE_TRIANGLES
        | TriMeshFlags::DELETE_DUPLICATE_TRIANGLES;
    let Ok(mut mesh) = TriMesh::with_flags(vertices, triangles, welded) else {
        return Err(MeshError::WithoutArea { triangles: count });
    };
    let edges = MeshEdges::of(mesh.indices());
    let sides = if ground {
        MeshSides::Ground
    } else if edges.are_closed() {
        MeshSides::Closed
    } else {
        MeshSides::Open
    };
    if sides == MeshSides::Closed && volume(mesh.vertices(), mesh.indices()) < 0.0 {
        mesh.reverse();
    }
    if sides != MeshSides::Open {
        // Parry refuses a mesh only if its topology is requested.
        let _ = mesh.set_flags(welded | TriMeshFlags::ORIENTED);
    }
    let sharp = edges.sharp(mesh.vertices(), mesh.indices(), sides != MeshSides::Open);
    Ok((mesh, sides, sharp))
}

/// The volume inside of closed triangles (m³), negative if they are inside out.
pub(in crate::contact::colliders) fn volume(vertices: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    // Relative to one of them, as they may be far from the origin.
    let middle = vertices.first().copied().unwrap_or_default().as_dvec3();
    let parts = triangles.iter().map(|triangle| {
        let [a, b, c]: [DVec3; 3] =
            triangle.map(|corner| vertices[corner as usize].as_dvec3() - middle);
        a.dot(b.cross(c)) / 6.0
    });
    parts.sum()
}
