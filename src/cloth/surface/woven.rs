//! The direction of the warp in each face of a mesh, and the springs of a woven one.

use std::sync::OnceLock;

use bevy::{
    math::{Vec2, Vec3},
    reflect::Reflect,
};
use thiserror::Error;

use super::{
    Surface,
    calibration::calibrate,
    springs::{Link, for_each_link, sides_of},
    triangles::TriangleMesh,
};
use crate::cloth::{arrays::sorted, spring::SpringKind};

/// A triangle whose area in the texture is less than this fraction of its squared size there has no direction.
const FOLDED: f32 = 1.0e-6;
/// An axis is perpendicular to a face if less than this fraction of it lies in the face.
const PERPENDICULAR: f32 = 1.0e-3;

/// The reason why a mesh has no grain.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum GrainError {
    /// The axis of a [`ClothGrain`](crate::cloth::ClothGrain) has no direction.
    #[error("the axis of a grain must be finite and have a length: {axis}")]
    Axis {
        /// The axis.
        axis: Vec3,
    },
    /// A mesh with a weft has no texture coordinates that its warp could follow.
    #[error("a weft on a mesh needs texture coordinates to follow, or a `ClothGrain` with an axis")]
    NeedsUvs,
    /// A triangle of a mesh with a weft has no area in the texture, and so no direction of its warp.
    #[error(
        "triangle {triangle} has no area in the texture, so its warp has no direction: unfold it, or insert a `ClothGrain` with an axis"
    )]
    FoldedUvs {
        /// Index of the triangle.
        triangle: usize,
    },
}

impl Surface {
    /// Gives each face of a mesh the direction of its warp, of length 1.
    pub(crate) fn with_grain(mut self, grain: Vec<Vec3>) -> Self {
        self.grain = grain;
        self.derived.bending = OnceLock::new();
        self
    }

    /// The normal of a face at rest, of length 1.
    pub(crate) fn face_normal(&self, face: [u32; 3]) -> Vec3 {
        let [a, b, c] = face.map(|corner| self.rest[corner as usize]);
        (b - a).cross(c - a).normalize_or(Vec3::Y)
    }

    /// The direction in each face that is nearest to an axis in the entity's frame; any where it is perpendicular.
    pub(crate) fn grain_along(&self, axis: Vec3) -> Vec<Vec3> {
        // As the cloth is scaled.
        let axis = (axis * self.scale).normalize_or(axis);
        let faces = self.triangles().iter();
        faces
            .map(|face| {
                let normal = self.face_normal(*face);
                let within = axis.reject_from_normalized(normal);
                match within.length() > PERPENDICULAR {
                    true => within.normalize(),
                    false => normal.any_orthonormal_vector(),
                }
            })
            .collect()
    }

    /// The direction of V in each face. `mesh` is the one that the surface was made from.
    ///
    /// # Errors
    /// [`GrainError::NeedsUvs`] without texture coordinates; [`GrainError::FoldedUvs`] for the first face without an
    /// area in the texture.
    pub(crate) fn grain_of_texture(&self, mesh: &TriangleMesh) -> Result<Vec<Vec3>, GrainError> {
        let vertices = self.vertices();
        if mesh.uvs.len() != vertices || mesh.positions.len() != vertices {
            return Err(GrainError::NeedsUvs);
        }
        // A face is the first of the triangles between its particles.
        let particle = |vertex: u32| Some(self.particle_of_vertex(vertex as usize)? as u32);
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        for (index, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            if let (Some(a), Some(b), Some(c)) = (particle(a), particle(b), particle(c)) {
                triangles.push((sorted([a, b, c]), index));
            }
        }
        triangles.sort_unstable();
        let of_face = |face: &[u32; 3]| {
            let corners = sorted(*face);
            let at = triangles.partition_point(|(known, _)| *known < corners);
            let found = triangles.get(at).filter(|(known, _)| *known == corners);
            let (_, triangle) = *found.ok_or(GrainError::NeedsUvs)?;
            self.along_v(mesh, mesh.triangles[triangle])
                .ok_or(GrainError::FoldedUvs { triangle })
        };
        self.triangles().iter().map(of_face).collect()
    }

    /// The direction of V in a triangle of vertices, of length 1; `None` if it has no area in the texture.
    fn along_v(&self, mesh: &TriangleMesh, triangle: [u32; 3]) -> Option<Vec3> {
        let [a, b, c] = triangle.map(|vertex| vertex as usize);
        let place = |vertex: usize| Some(self.rest[self.particle_of_vertex(vertex)?]);
        let (b_place, c_place) = (place(b)? - place(a)?, place(c)? - place(a)?);
        let [b, c]: [Vec2; 2] = [b, c].map(|vertex| mesh.uvs[vertex] - mesh.uvs[a]);
        let area = b.perp_dot(c);
        let size = b.length_squared().max(c.length_squared());
        if area.is_nan() || area.abs() <= FOLDED * size {
            return None;
        }
        (area.signum() * (b.x * c_place - c.x * b_place)).try_normalize()
    }

    /// Calls `visit` with each edge that has a spring along it: its ends, its length at rest (m), and the square of the cosine of
    /// its angle with the warp, 1 without a grain. Diagonals of a grid are left out.
    pub(crate) fn for_each_thread(&self, mut visit: impl FnMut([u32; 2], f32, f32)) {
        if let Some(grid) = &self.grid {
            let (columns, spacing) = (grid.columns(), grid.spacing());
            for index in 0..self.len() as u32 {
                if (index + 1) % columns > 0 {
                    visit([index, index + 1], spacing.x, 0.0);
                }
                if ((index + columns) as usize) < self.len() {
                    visit([index, index + columns], spacing.y, 1.0);
                }
            }
            return;
        }
        if self.grain.is_empty() {
            return (self.edges()).for_each(|link| visit(link.ends, link.rest_length, 1.0));
        }
        let along_warp = self.derived.along_warp.get_or_init(|| self.along_warp());
        for (link, along_warp) in self.edges().zip(along_warp) {
            visit(link.ends, link.rest_length, *along_warp);
        }
    }

    /// The square of the cosine between each edge of a mesh and the warp beside it, in the order of its links.
    fn along_warp(&self) -> Vec<f32> {
        let of_link = |link: &Link| {
            let [a, b] = link.ends.map(|end| self.rest[end as usize]);
            let direction = (b - a).normalize_or_zero();
            let beside = self.incidence().at(link.ends).first();
            let cosine = beside.map_or(1.0, |side| self.grain[side.face as usize].dot(direction));
            (cosine * cosine).min(1.0)
        };
        self.edges().map(of_link).collect()
    }

    /// The springs of a mesh whose weft is t⁴ times as compliant as its warp; `None` if they are the usual
    /// [links](Self::links). See [`calibrate`].
    pub(crate) fn woven_links(&self, ratio: f32) -> Option<Vec<Link>> {
        if self.grain.is_empty() || ratio == 1.0 {
            return None;
        }
        let ratio = f64::from(ratio);
        let faces = self.triangles();
        let (mut along, mut across, mut softness) = (Vec::new(), Vec::new(), Vec::new());
        for_each_link(faces, &sides_of(faces), &self.rest, |mut link, sides| {
            let [a, b] = link.ends.map(|end| self.rest[end as usize]);
            let span = (b - a).normalize_or_zero();
            let along_warp = |face: u32| {
                let cosine = f64::from(self.grain[face as usize].dot(span));
                cosine * cosine
            };
            let sum: f64 = sides.iter().map(|side| along_warp(side.face)).sum();
            let warp = (sum / sides.len() as f64).min(1.0);
            let soft = warp / ratio + (1.0 - warp) * ratio;
            if link.kind == SpringKind::Structural {
                along.push(link);
                softness.push(soft);
            } else {
                link.slenderness *= soft.powi(3) as f32;
                across.push(link);
            }
        });
        let normals: Vec<Vec3> = (0..self.len()).map(|at| self.normal_of(at)).collect();
        let softness = |at: usize| softness[at];
        calibrate(&mut along, &self.rest, &normals, &self.is_border, softness);
        across.append(&mut along);
        Some(across)
    }
}
