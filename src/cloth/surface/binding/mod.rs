//! Binds a fine mesh to a coarse surface.
//!
//! Each vertex is bound to the nearest point of the surface at rest. That point lies in a face with the corners *a*,
//! *b*, *c*, at the barycentric coordinates *u*, *v*, *w*. It has its own frame:
//!
//! ```text
//! N = normalised (u N_a + v N_b + w N_c)                              the interpolated normal
//! T = normalised part of α (x_b − x_a) + β (x_c − x_a) across N       as the vertex's own tangent points, by α and β
//! B = N × T
//! ```
//!
//! The vertex's offset from its point, its normal and its tangent are stored in that frame. When the surface moves, the
//! frame is computed again from the particles' positions, and it rotates all three along: right angles stay right
//! angles. *N* is continuous over the edges of faces, so a fine mesh looks smooth on a coarse cloth. (This is a wrap
//! deformer with the usual tangent-space frame.)

use bevy::math::Vec3;
use parry3d::{query::PointQueryWithLocation, shape::TriMesh};

use super::{
    Surface,
    bound::{Bound, Eight, Frame, write_eights},
    triangles::MeshError,
};
use crate::cloth::lanes::LANES;

/// The least tangential part of a tangent, as a fraction, for the frame to follow it.
const LEAST_ALONG: f32 = 0.1;

/// A mesh bound to a surface: its vertices follow the particles.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct SurfaceBinding {
    eights: Vec<Eight>,
    len: usize,
    has_tangents: bool,
}

impl SurfaceBinding {
    /// Binds vertices, given in the surface's frame (m), to a surface at rest. There is one normal for each vertex, and
    /// one tangent for each vertex or none at all.
    ///
    /// # Errors
    /// [`MeshError::VertexNotFinite`] for the first vertex that is not finite. [`MeshError::BoundTooFar`] for a
    /// vertex farther from the surface than the surface's diagonal. [`MeshError::WithoutArea`] for a surface
    /// without faces.
    pub fn new(
        surface: &Surface,
        positions: &[Vec3],
        normals: &[Vec3],
        tangents: &[Vec3],
    ) -> Result<Self, MeshError> {
        MeshError::check_vertices(positions, Vec3::ONE)?;
        let rest = surface.rest_positions();
        let faces = surface.triangles();
        let mesh = TriMesh::new(rest.to_vec(), faces.to_vec());
        let triangles = faces.len();
        let mesh = mesh.map_err(|_| MeshError::WithoutArea { triangles })?;
        let mut at_rest = Vec::new();
        surface.normals_at(rest, &mut at_rest);
        let has_tangents = tangents.len() == positions.len() && !tangents.is_empty();
        let mut vertices = Vec::with_capacity(positions.len());
        for (vertex, &position) in positions.iter().enumerate() {
            let (nearest, (face, place)) =
                mesh.project_local_point_and_get_location(position, false);
            let distance = nearest.point.distance(position);
            if distance.is_nan() || distance > surface.diagonal() {
                return Err(MeshError::BoundTooFar {
                    vertex,
                    distance,
                    farthest: surface.diagonal(),
                });
            }
            let weights = place.barycentric_coordinates().unwrap_or([1.0, 0.0, 0.0]);
            let corners = faces[face as usize];
            let [tangent, normal] = [tangents, normals].map(|of| of.get(vertex).copied());
            let tangent = tangent.filter(|_| has_tangents).unwrap_or_default();
            let normal = normal.unwrap_or_default();
            let places = corners.map(|corner| rest[corner as usize]);
            let along = along(places, tangent).or_else(|| along(places, normal));
            let along = along.unwrap_or([1.0, 0.0]);
            let around = corners.map(|corner| at_rest[corner as usize]);
            let frame = Frame::new(places, around, weights, along);
            vertices.push(Bound {
                corners,
                weights,
                along,
                inside: [position - frame.point, normal, tangent].map(|out| frame.inside(out)),
            });
        }
        Ok(Self {
            eights: vertices.chunks(LANES).map(Eight::of).collect(),
            len: vertices.len(),
            has_tangents,
        })
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.len
    }

    /// The particles of the face that a vertex is bound to.
    #[cfg(feature = "mesh")]
    pub(crate) fn face_of(&self, vertex: usize) -> [u32; 3] {
        self.eights[vertex / LANES].lane(vertex % LANES).corners
    }

    /// Whether there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether the vertices have tangents.
    pub fn has_tangents(&self) -> bool {
        self.has_tangents
    }

    /// Writes the vertices' positions (m), normals and tangents (x, y and z). `particles` are the positions of the
    /// surface's particles (m), and `around` their [`normals`](Surface::normals_at). Normals and tangents keep their
    /// lengths at rest. A slice that is too short is filled to its end. Without tangents, none are written.
    pub fn write(
        &self,
        particles: &[Vec3],
        around: &[Vec3],
        positions: &mut [[f32; 3]],
        normals: &mut [[f32; 3]],
        tangents: &mut [[f32; 4]],
    ) {
        let tangents = if self.has_tangents { tangents } else { &mut [] };
        let around = [particles, around];
        write_eights(&self.eights, around, positions, normals, tangents);
    }
}

/// Coordinates of a vector's tangential part along a face's two edges from its first corner. `None` if that part is
/// almost zero.
fn along([a, b, c]: [Vec3; 3], vector: Vec3) -> Option<[f32; 2]> {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac).try_normalize()?;
    let inside = vector.reject_from_normalized(normal);
    if inside.length_squared() < LEAST_ALONG * LEAST_ALONG * vector.length_squared()
        || inside == Vec3::ZERO
    {
        return None;
    }
    let area = ab.cross(ac).dot(normal);
    Some([
        inside.cross(ac).dot(normal) / area,
        ab.cross(inside).dot(normal) / area,
    ])
}

#[cfg(test)]
mod tests;
