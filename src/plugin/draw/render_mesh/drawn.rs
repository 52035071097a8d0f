//! The picture of a mesh that a cloth drives.

use bevy::{
    asset::RenderAssetUsages,
    math::Affine3A,
    mesh::VertexAttributeValues,
    prelude::{GlobalTransform, Mesh, Vec3, Vec4},
};

use crate::{
    cloth::{ClothError, Surface, SurfaceBinding, TriangleMesh, add_face_normals},
    plugin::{
        draw::mesh::{MeshDrawing, Vectors, with_triangles},
        frame::{rigid, unusable},
    },
};

/// A mesh that is bound to a surface, and its drawn place.
#[derive(Debug)]
pub(super) struct Driven {
    binding: SurfaceBinding,
    /// Drawn positions and normals of the particles, in the frame of the mesh's entity without its scale (m).
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    /// The transform that takes out the entity's scale, if it has one.
    unscaled: Option<Affine3A>,
    /// The version of the cloth that it is drawn on, and the cloth's place relative to the mesh's entity.
    drawn: Option<(u32, Affine3A, Affine3A)>,
}

impl Driven {
    /// Binds an asset, on an entity at `place`, to the surface of a cloth whose entity is at `cloth`. Also returns the
    /// copy of the asset that is drawn.
    ///
    /// # Errors
    /// The error of the asset or of a transform, or [`BoundTooFar`](crate::cloth::MeshError::BoundTooFar).
    pub fn new(
        asset: &Mesh,
        surface: &Surface,
        place: &GlobalTransform,
        cloth: &GlobalTransform,
    ) -> Result<(Mesh, Self), ClothError> {
        let TriangleMesh {
            mut positions,
            triangles,
            mut normals,
            ..
        } = TriangleMesh::of_asset(asset)?;
        if normals.len() != positions.len() {
            normals = normals_of(&positions, &triangles);
        }
        let mut mesh = asset.clone();
        mesh.asset_usage = RenderAssetUsages::default();
        // Bones would move vertices that the cloth has moved already.
        mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
        mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
        let own: Vec<_> = normals.iter().map(Vec3::to_array).collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, own);
        let tangents: &[[f32; 4]] = match mesh.try_attribute(Mesh::ATTRIBUTE_TANGENT) {
            Ok(VertexAttributeValues::Float32x4(values)) => values,
            _ => &[],
        };
        let tangent = |value: &[f32; 4]| Vec4::from(*value).truncate();
        let mut tangents: Vec<Vec3> = tangents.iter().map(tangent).collect();
        let to_surface = Affine3A::from(rigid(&cloth.affine()).inverse()) * place.affine();
        let for_normals = to_surface.matrix3.inverse().transpose();
        if !(to_surface.is_finite() && for_normals.is_finite()) {
            return Err(unusable(place.affine()));
        }
        for position in &mut positions {
            *position = to_surface.transform_point3(*position);
        }
        for normal in &mut normals {
            *normal = (for_normals * *normal).normalize_or(Vec3::Y);
        }
        for tangent in &mut tangents {
            *tangent = (to_surface.matrix3 * *tangent).normalize_or(Vec3::X);
        }
        let binding = SurfaceBinding::new(surface, &positions, &normals, &tangents)?;
        if surface.is_torn() {
            mesh = without_gaps(&mesh, &triangles, surface, &binding);
        }
        let driven = Self {
            binding,
            positions: Vec::new(),
            normals: Vec::new(),
            unscaled: None,
            drawn: None,
        };
        Ok((mesh, driven))
    }

    /// Takes over the drawn positions of a cloth. Its entity is drawn at `at`, the mesh's entity at `place`. Returns
    /// whether the picture changes.
    pub fn follow(
        &mut self,
        surface: &Surface,
        cloth: &MeshDrawing,
        place: &GlobalTransform,
        at: &GlobalTransform,
    ) -> bool {
        let (version, drawn) = (cloth.version, &cloth.drawn);
        let own = Affine3A::from(rigid(&place.affine()));
        let from_cloth = own.inverse() * at.affine();
        let scale = own.inverse() * place.affine();
        let wanted = Some((version, from_cloth, scale));
        let unscaled = scale.inverse();
        if self.drawn == wanted
            || drawn.len() != surface.len()
            || !(from_cloth.is_finite() && unscaled.is_finite())
        {
            return false;
        }
        self.drawn = wanted;
        // A rotation is read out of a transform with some roundings.
        let is_scaled = !scale.abs_diff_eq(Affine3A::IDENTITY, 1.0e-6);
        self.unscaled = is_scaled.then_some(unscaled);
        self.positions.clear();
        let places = drawn.iter().map(|at| from_cloth.transform_point3(*at));
        self.positions.extend(places);
        surface.normals_at(&self.positions, &mut self.normals);
        true
    }

    /// Writes the vertices into a mesh.
    pub fn write(&self, mesh: &mut Mesh) {
        let Vectors {
            positions: Some(positions),
            normals: Some(normals),
            tangents,
        } = Vectors::of(mesh)
        else {
            return;
        };
        let tangents = tangents.map_or(&mut [][..], |tangents| &mut tangents[..]);
        let around = &self.normals;
        self.binding
            .write(&self.positions, around, positions, normals, tangents);
        if let Some(by) = self.unscaled {
            let for_normals = by.matrix3.inverse().transpose();
            for position in positions {
                *position = by.transform_point3((*position).into()).to_array();
            }
            for normal in &mut *normals {
                let turned = for_normals * Vec3::from(*normal);
                *normal = turned.normalize_or(Vec3::Y).to_array();
            }
            // Still at right angles to the normals: these are turned by the inverse of the transpose.
            for tangent in tangents {
                let turned = by.matrix3 * Vec4::from(*tangent).truncate();
                [tangent[0], tangent[1], tangent[2]] = turned.normalize_or(Vec3::X).to_array();
            }
        }
    }
}

/// A mesh without the triangles that span a tear: those with corners on faces that do not hang together any more.
fn without_gaps(
    mesh: &Mesh,
    triangles: &[[u32; 3]],
    surface: &Surface,
    binding: &SurfaceBinding,
) -> Mesh {
    let is_whole = |[a, b, c]: &&[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|vertex| binding.face_of(*vertex as usize));
        surface.hang_together(a, b) && surface.hang_together(b, c)
    };
    with_triangles(mesh, triangles.iter().filter(is_whole))
}

/// The normals of a mesh that has none: of its faces at each vertex, by their areas.
fn normals_of(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let count = positions.len();
    let exists = |triangle: &&[u32; 3]| triangle.iter().all(|at| (*at as usize) < count);
    let mut normals = vec![Vec3::ZERO; count];
    add_face_normals(triangles.iter().filter(exists), positions, &mut normals);
    let unit = |normal: Vec3| normal.normalize_or(Vec3::Y);
    normals.into_iter().map(unit).collect()
}
