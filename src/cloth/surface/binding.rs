//! How a fine mesh hangs on a coarse surface.
//!
//! Each vertex is bound to the nearest point of the surface at rest, which lies in a face of the corners *a*, *b*, *c* with
//! the barycentric coordinates *u*, *v*, *w*. There it has a frame of its own:
//!
//! - *N* = (u N_a + v N_b + w N_c) normalised, the interpolated normal;
//! - *T*, the part of α (x_b − x_a) + β (x_c − x_a) that is at right angles to *N*, normalised. α and β say which way in the face the
//!   vertex's own tangent points;
//! - *B* = *N* × *T*.
//!
//! What the vertex is away from its point, its normal and its tangent are kept in that frame. Where the surface has moved, the
//! frame is made again from where the particles are, and all three are taken along by it, as by a rotation: what is at right angles stays
//! so. *N* is continuous over the edges of faces, so a fine mesh looks smooth on a coarse cloth. (Known as wrap
//! deformers; the frame is the usual one of tangent space.)

use bevy::math::Vec3;
use parry3d::{query::PointQueryWithLocation, shape::TriMesh};

use super::Surface;
use crate::cloth::{ClothError, FARTHEST};

/// What of a tangent has to lie in the surface, for the frame to follow it.
const LEAST_ALONG: f32 = 0.1;

/// A mesh that is bound to a surface: where its vertices are follows from where the particles are.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct SurfaceBinding {
    vertices: Vec<Bound>,
    has_tangents: bool,
}

/// A vertex of it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bound {
    corners: [u32; 3],
    /// Barycentric coordinates of its point.
    weights: [f32; 3],
    /// α and β.
    along: [f32; 2],
    /// From its point to the vertex, in its frame (m).
    offset: Vec3,
    /// Its normal and its tangent, in its frame.
    normal: Vec3,
    tangent: Vec3,
}

/// Vertices where a surface takes them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BoundVertex {
    /// Where it is (m).
    pub position: Vec3,
    /// Its normal, as long as at rest.
    pub normal: Vec3,
    /// Its tangent, as long as at rest; zero of a mesh without tangents.
    pub tangent: Vec3,
}

/// Where a vertex's point is, and its frame.
struct Frame {
    point: Vec3,
    along: Vec3,
    across: Vec3,
    normal: Vec3,
}

impl Frame {
    #[inline(always)]
    fn new([a, b, c]: [Vec3; 3], normals: [Vec3; 3], weights: [f32; 3], along: [f32; 2]) -> Self {
        let blend = |[a, b, c]: [Vec3; 3]| a * weights[0] + b * weights[1] + c * weights[2];
        let (ab, ac) = (b - a, c - a);
        // Opposite normals cancel out in a face that is folded up: its own is left.
        let normal = blend(normals).try_normalize();
        let normal = normal.unwrap_or_else(|| ab.cross(ac).normalize_or(Vec3::Y));
        let direction = ab * along[0] + ac * along[1];
        let across = (direction - normal * normal.dot(direction)).try_normalize();
        let along = across.unwrap_or_else(|| normal.any_orthonormal_vector());
        Self {
            point: blend([a, b, c]),
            along,
            across: normal.cross(along),
            normal,
        }
    }

    /// A vector that is given in the frame.
    #[inline(always)]
    fn out(&self, inside: Vec3) -> Vec3 {
        self.along * inside.x + self.across * inside.y + self.normal * inside.z
    }

    /// A vector as the frame has it.
    fn inside(&self, out: Vec3) -> Vec3 {
        Vec3::new(
            out.dot(self.along),
            out.dot(self.across),
            out.dot(self.normal),
        )
    }
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
                offset: frame.inside(position - frame.point),
                normal: frame.inside(normal),
                tangent: frame.inside(tangent),
            });
        }
        Ok(Self {
            vertices,
            has_tangents,
        })
    }

    /// How many vertices there are.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Whether the vertices have tangents.
    pub fn has_tangents(&self) -> bool {
        self.has_tangents
    }

    /// Where the vertices are, and how they face, while the particles are at `positions` (m) and
    /// [`Surface::normals_at`] are the `normals` there. Both are as many as the surface has particles.
    pub fn vertices<'a>(
        &'a self,
        positions: &'a [Vec3],
        normals: &'a [Vec3],
    ) -> impl ExactSizeIterator<Item = BoundVertex> + 'a {
        self.vertices.iter().map(|bound| {
            let places = bound.corners.map(|corner| positions[corner as usize]);
            let around = bound.corners.map(|corner| normals[corner as usize]);
            let frame = Frame::new(places, around, bound.weights, bound.along);
            BoundVertex {
                position: frame.point + frame.out(bound.offset),
                normal: frame.out(bound.normal),
                tangent: frame.out(bound.tangent),
            }
        })
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
