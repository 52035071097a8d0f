//! The drawn mesh: vertices, normals and tangents that follow the particles of a surface.

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, MeshVertexAttributeId, PrimitiveTopology, VertexAttributeValues},
    platform::collections::HashMap,
    prelude::{Mesh, Vec2, Vec3},
};

use super::tube;
use crate::cloth::{Surface, TriangleMesh, sorted};

/// A mesh of a surface at rest, with the vertices that it was made from, and texture coordinates and tangents where it has
/// them.
pub(super) fn mesh_of(surface: &Surface) -> (Mesh, TornVertices) {
    let vertices = TornVertices::of_particles(surface);
    if tube::radius_of(surface).is_some() {
        return (tube::mesh_of(surface), vertices);
    }
    let count = vertices.len(surface);
    let particles = (0..count).map(|vertex| vertices.particle_of(surface, vertex));
    let mut vertex_of = vec![0; surface.len()];
    for (vertex, particle) in particles.clone().enumerate().rev() {
        if let Some(particle) = particle {
            vertex_of[particle] = vertex as u32;
        }
    }
    // A vertex without a particle belongs to no triangle.
    let place = |of: Option<usize>| of.map_or(Vec3::ZERO, |of| surface.rest_positions()[of]);
    let normal = |of: Option<usize>| of.map_or(Vec3::Y, |of| surface.normal_of(of));
    let positions: Vec<_> = particles.clone().map(|of| place(of).to_array()).collect();
    let normals: Vec<_> = particles.map(|of| normal(of).to_array()).collect();
    let corners = surface.triangles().iter().flatten();
    let indices = corners.map(|corner| vertex_of[*corner as usize]).collect();
    let usage = RenderAssetUsages::default();
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, usage)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_indices(Indices::U32(indices));
    // Surfaces that the game gives as triangles have none.
    if surface.uvs().len() == count {
        let uvs: Vec<_> = surface.uvs().iter().map(Vec2::to_array).collect();
        let tangents = vec![[1.0, 0.0, 0.0, 1.0]; count];
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
        mesh.insert_attribute(Mesh::ATTRIBUTE_TANGENT, tangents);
    }
    (mesh, vertices)
}

/// The particle of each vertex of the mesh of a torn surface, in place of the surface's own.
#[derive(Debug, Default)]
pub(super) struct TornVertices(Vec<u32>);

impl TornVertices {
    /// Each particle has a vertex of its own.
    fn of_particles(surface: &Surface) -> Self {
        let count = if surface.is_torn() { surface.len() } else { 0 };
        Self((0..count as u32).collect())
    }

    /// The particle of a vertex.
    pub fn particle_of(&self, surface: &Surface, vertex: usize) -> Option<usize> {
        if self.0.is_empty() {
            return surface.particle_of_vertex(vertex);
        }
        let particle = *self.0.get(vertex)? as usize;
        (particle < surface.len()).then_some(particle)
    }

    /// Number of vertices.
    pub fn len(&self, surface: &Surface) -> usize {
        match (self.0.len(), tube::radius_of(surface)) {
            (_, Some(_)) => tube::vertices(surface),
            (0, _) => surface.vertices(),
            (count, _) => count,
        }
    }

    /// Splits the vertices of an asset's mesh as the surface's particles are.
    fn split(mesh: &mut Mesh, surface: &Surface, mut triangles: Vec<[u32; 3]>) -> Self {
        if !surface.is_torn() {
            return Self::default();
        }
        let vertices = surface.vertices();
        let particle = |vertex| surface.particle_of_vertex(vertex);
        let whole = (0..vertices).map(|vertex| particle(vertex).map_or(u32::MAX, |of| of as u32));
        let mut particles: Vec<u32> = whole.collect();
        let faces = surface.faces_by_origin();
        let mut origins: Vec<u32> = (0..vertices as u32).collect();
        let mut split: HashMap<(u32, u32), u32> = HashMap::default();
        for triangle in &mut triangles {
            let of_vertices = triangle.map(|vertex| particles[vertex as usize]);
            let Some(face) = faces.get(&sorted(of_vertices)) else {
                continue;
            };
            for (vertex, whole) in triangle.iter_mut().zip(of_vertices) {
                let part = face.iter().find(|part| surface.origin_of(**part) == whole);
                let part = part.copied().unwrap_or(whole);
                if part != whole {
                    *vertex = *split.entry((*vertex, part)).or_insert_with(|| {
                        origins.push(*vertex);
                        particles.push(part);
                        origins.len() as u32 - 1
                    });
                }
            }
        }
        mesh.insert_indices(Indices::U32(origins));
        mesh.duplicate_vertices();
        *mesh = with_triangles(mesh, triangles.iter());
        Self(particles)
    }
}

/// A copy of a mesh with these triangles in place of its own.
pub(in crate::plugin::draw) fn with_triangles<'a>(
    mesh: &Mesh,
    triangles: impl Iterator<Item = &'a [u32; 3]>,
) -> Mesh {
    let mut list = Mesh::new(PrimitiveTopology::TriangleList, mesh.asset_usage);
    for (attribute, values) in mesh.attributes() {
        list.insert_attribute(*attribute, values.clone());
    }
    let corners = triangles.flatten().copied().collect();
    list.with_inserted_indices(Indices::U32(corners))
}

/// A copy of an asset for one cloth: it is read and written, and lit. Triangles outside the surface are left out, as
/// their corners do not move. `None` if the asset can't be read, or does not match the surface.
pub(super) fn copy_of(asset: &Mesh, surface: &Surface) -> Option<(Mesh, TornVertices)> {
    let TriangleMesh {
        positions,
        mut triangles,
        normals,
        ..
    } = TriangleMesh::of_asset(asset).ok()?;
    if positions.len() != surface.vertices() {
        return None;
    }
    let mut mesh = asset.clone();
    mesh.asset_usage = RenderAssetUsages::default();
    // Bones would move vertices that the simulation has moved already.
    mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
    mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
    // And the bounds of a skeleton are not the cloth's.
    mesh.set_skinned_mesh_bounds(None);
    if normals.is_empty() {
        let up = vec![Vec3::Y.to_array(); positions.len()];
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, up);
    }
    let count = triangles.len();
    let moves = |corner: &u32| surface.particle_of_vertex(*corner as usize).is_some();
    triangles.retain(|triangle| triangle.iter().all(moves));
    if triangles.len() < count {
        mesh = with_triangles(&mesh, triangles.iter());
    }
    let vertices = TornVertices::split(&mut mesh, surface, triangles);
    Some((mesh, vertices))
}

/// The vectors of a mesh that follow a cloth, those that it has.
#[derive(Default)]
pub(in crate::plugin::draw) struct Vectors<'a> {
    pub positions: Option<&'a mut Vec<[f32; 3]>>,
    pub normals: Option<&'a mut Vec<[f32; 3]>>,
    pub tangents: Option<&'a mut Vec<[f32; 4]>>,
}

impl<'a> Vectors<'a> {
    pub fn of(mesh: &'a mut Mesh) -> Self {
        let mut vectors = Self::default();
        for (attribute, values) in mesh.try_attributes_mut().into_iter().flatten() {
            match (attribute.id, values) {
                (POSITION, VertexAttributeValues::Float32x3(of)) => vectors.positions = Some(of),
                (NORMAL, VertexAttributeValues::Float32x3(of)) => vectors.normals = Some(of),
                (TANGENT, VertexAttributeValues::Float32x4(of)) => vectors.tangents = Some(of),
                _ => {}
            }
        }
        vectors
    }
}

const POSITION: MeshVertexAttributeId = Mesh::ATTRIBUTE_POSITION.id;
const NORMAL: MeshVertexAttributeId = Mesh::ATTRIBUTE_NORMAL.id;
const TANGENT: MeshVertexAttributeId = Mesh::ATTRIBUTE_TANGENT.id;

/// How the tangents of a mesh follow its vertices: by the texture coordinates of its triangles.
#[derive(Debug, Default)]
pub(super) struct Tangents {
    triangles: Vec<[u32; 3]>,
    /// The direction of growing u, as factors of both edges from a triangle's first corner.
    parts: Vec<[f32; 2]>,
    /// The sum over the triangles at each vertex.
    sums: Vec<Vec3>,
}

impl Tangents {
    /// Tangents of a mesh that has tangents and texture coordinates; none for any other.
    pub fn of(mesh: &Mesh) -> Self {
        let Ok(TriangleMesh { triangles, uvs, .. }) = TriangleMesh::of_asset(mesh) else {
            return Self::default();
        };
        let exists = |corner: &u32| (*corner as usize) < uvs.len();
        let has_tangents = mesh.try_attribute(Mesh::ATTRIBUTE_TANGENT).is_ok();
        if !has_tangents || !triangles.iter().flatten().all(exists) {
            return Self::default();
        }
        let parts = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| uvs[corner as usize]);
            let (ab, ac) = (b - a, c - a);
            // Weighted by the triangle's area in the texture; negative where it is mirrored.
            let side = ab.perp_dot(ac).signum();
            [ac.y * side, -ab.y * side]
        };
        Self {
            parts: triangles.iter().map(parts).collect(),
            sums: vec![Vec3::ZERO; uvs.len()],
            triangles,
        }
    }

    /// Writes the tangents, if there are any.
    pub fn write(&mut self, vectors: Vectors) {
        let (triangles, parts, sums) = (&self.triangles, &self.parts, &mut self.sums);
        if triangles.is_empty() {
            return;
        }
        if let Some(places) = vectors.positions
            && places.len() == sums.len()
        {
            sums.fill(Vec3::ZERO);
            for (triangle, parts) in triangles.iter().zip(parts) {
                let [a, b, c] = triangle.map(|corner| Vec3::from(places[corner as usize]));
                let along = (b - a) * parts[0] + (c - a) * parts[1];
                for corner in triangle {
                    sums[*corner as usize] += along;
                }
            }
        }
        let (Some(normals), Some(tangents)) = (vectors.normals, vectors.tangents) else {
            return;
        };
        for ((tangent, normal), along) in tangents.iter_mut().zip(&*normals).zip(sums) {
            let normal = Vec3::from(*normal);
            let across = along.reject_from_normalized(normal);
            let direction = across.normalize_or(normal.any_orthonormal_vector());
            // The sign of the bitangent does not change.
            [tangent[0], tangent[1], tangent[2]] = direction.to_array();
        }
    }
}
