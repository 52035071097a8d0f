//! How a fine mesh hangs on a coarse surface.
//!
//! Each vertex is bound to the nearest point of the surface at rest, which lies in a face of the corners *a*, *b*, *c* with
//! the barycentric coordinates *u*, *v*, *w*. There it has a frame of its own:
//!
//! ```text
//! N = normalised (u N_a + v N_b + w N_c)                              the interpolated normal
//! T = normalised part of α (x_b − x_a) + β (x_c − x_a) across N       as the vertex's own tangent points, by α and β
//! B = N × T
//! ```
//!
//! What the vertex is away from its point, its normal and its tangent are kept in that frame. Where the surface has moved, the
//! frame is made again from where the particles are, and all three are taken along by it, as by a rotation: what is at right angles stays
//! so. *N* is continuous over the edges of faces, so a fine mesh looks smooth on a coarse cloth. (Known as wrap
//! deformers; the frame is the usual one of tangent space.)

use bevy::math::Vec3;
use parry3d::{query::PointQueryWithLocation, shape::TriMesh};

use super::{
    Surface,
    bound::{Bound, Eight, Frame, write_eights},
};
use crate::cloth::{ClothError, FARTHEST, LANES};

/// What of a tangent has to lie in the surface, for the frame to follow it.
const LEAST_ALONG: f32 = 0.1;

/// A mesh that is bound to a surface: where its vertices are follows from where the particles are.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct SurfaceBinding {
    eights: Vec<Eight>,
    len: usize,
    has_tangents: bool,
}

impl SurfaceBinding {
    /// Binds vertices, given in the surface's frame (m), to a surface at rest. There may be no tangents, else as many as
    /// vertices; as many normals.
    ///
    /// # Errors
    /// [`ClothError::VertexNotFinite`] for the first that is not; [`ClothError::BoundTooFar`] if one is farther from the surface than that
    /// measures from one end to the other; [`ClothError::MeshWithoutArea`] of a surface without faces.
    pub fn new(
        surface: &Surface,
        positions: &[Vec3],
        normals: &[Vec3],
        tangents: &[Vec3],
    ) -> Result<Self, ClothError> {
        let is_beyond = |at: &Vec3| !(at.is_finite() && at.abs().max_element() < FARTHEST);
        if let Some(vertex) = positions.iter().position(is_beyond) {
            return Err(ClothError::VertexNotFinite {
                vertex,
                position: positions[vertex],
            });
        }
        let rest = surface.rest_positions();
        let faces = surface.triangles();
        let mesh = TriMesh::new(rest.to_vec(), faces.to_vec());
        let mesh = mesh.map_err(|_| ClothError::MeshWithoutArea {
            triangles: faces.len(),
        })?;
        let mut at_rest = Vec::new();
        surface.normals_at(rest, &mut at_rest);
        let has_tangents = tangents.len() == positions.len() && !tangents.is_empty();
        let mut vertices = Vec::with_capacity(positions.len());
        for (vertex, &position) in positions.iter().enumerate() {
            let (nearest, (face, place)) =
                mesh.project_local_point_and_get_location(position, false);
            let distance = nearest.point.distance(position);
            if distance.is_nan() || distance > surface.diagonal() {
                return Err(ClothError::BoundTooFar {
                    vertex,
                    distance,
                    farthest: surface.diagonal(),
                });
            }
            let weights = place.barycentric_coordinates().unwrap_or([1.0, 0.0, 0.0]);
            let corners = faces[face as usize];
            let tangent = if has_tangents {
                tangents[vertex]
            } else {
                Vec3::ZERO
            };
            let normal = normals.get(vertex).copied().unwrap_or(Vec3::ZERO);
            let places = corners.map(|corner| rest[corner as usize]);
            let along = [tangent, normal]
                .into_iter()
                .find_map(|vector| along(places, vector))
                .unwrap_or([1.0, 0.0]);
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

    /// How many vertices there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether the vertices have tangents.
    pub fn has_tangents(&self) -> bool {
        self.has_tangents
    }

    /// Writes where the vertices are (m), their normals and the first three numbers of their tangents, while the particles are at
    /// `particles` (m) and [`Surface::normals_at`] are the `around` there: both as many as the surface has particles. Normals and tangents
    /// are as long as they were at rest. Nothing is written beyond the end of what is too short, nor tangents where there are none.
    pub fn write(
        &self,
        particles: &[Vec3],
        around: &[Vec3],
        positions: &mut [[f32; 3]],
        normals: &mut [[f32; 3]],
        tangents: &mut [[f32; 4]],
    ) {
        let tangents = if self.has_tangents { tangents } else { &mut [] };
        write_eights(
            &self.eights,
            [particles, around],
            positions,
            normals,
            tangents,
        );
    }
}

/// How much of each of a face's edges from its first corner there is in the part of a vector that lies in the face, unless
/// next to nothing of it does.
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
