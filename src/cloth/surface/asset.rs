//! Triangles from Bevy's mesh assets.

use bevy::{
    asset::RenderAssetUsages,
    math::{Vec2, Vec3},
    mesh::{Mesh, MeshAccessError, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues},
};

use super::triangles::{JointWeights, MeshError, TriangleMesh, VertexAttribute};

/// Attributes that a surface stores in other ways or does not use.
const OTHERS: [MeshVertexAttribute; 7] = [
    Mesh::ATTRIBUTE_POSITION,
    Mesh::ATTRIBUTE_NORMAL,
    Mesh::ATTRIBUTE_TANGENT,
    Mesh::ATTRIBUTE_UV_0,
    Mesh::ATTRIBUTE_UV_1,
    Mesh::ATTRIBUTE_JOINT_INDEX,
    Mesh::ATTRIBUTE_JOINT_WEIGHT,
];

impl TriangleMesh {
    /// Reads the triangles of a mesh asset: a triangle list or strip, with 16-bit, 32-bit or no indices.
    ///
    /// # Errors
    /// [`MeshError::NotReadable`] for a mesh that is only in the render world; [`MeshError::Topology`] for
    /// lines or points; [`MeshError::WithoutPositions`]; [`MeshError::IndexCount`] for an incomplete
    /// triangle.
    pub fn of_asset(mesh: &Mesh) -> Result<Self, MeshError> {
        let positions = positions_of_asset(mesh)?;
        let read = |attribute| attribute_of(mesh, attribute);
        let triangles = triangles(mesh, positions.len())?;
        let uvs: &[[f32; 2]] = match read(Mesh::ATTRIBUTE_UV_0)? {
            Some(VertexAttributeValues::Float32x2(values)) => values,
            _ => &[],
        };
        let attributes = mesh.attributes().filter_map(|(attribute, values)| {
            let is_other = OTHERS.iter().any(|other| other.id == attribute.id);
            let values = numbers(values).filter(|_| !is_other)?;
            Some(VertexAttribute::new(attribute.name, values))
        });
        Ok(Self {
            positions,
            triangles,
            normals: vectors(read(Mesh::ATTRIBUTE_NORMAL)?).unwrap_or_default(),
            uvs: uvs.iter().copied().map(Vec2::from).collect(),
            attributes: attributes.collect(),
        })
    }
}

/// An attribute of a mesh, if it has it.
///
/// # Errors
/// [`MeshError::NotReadable`].
fn attribute_of(
    mesh: &Mesh,
    attribute: MeshVertexAttribute,
) -> Result<Option<&VertexAttributeValues>, MeshError> {
    match mesh.try_attribute_option(attribute) {
        Ok(values) => Ok(values),
        Err(MeshAccessError::ExtractedToRenderWorld) => Err(MeshError::NotReadable),
        Err(_) => Ok(None),
    }
}

/// The positions of a mesh's vertices.
///
/// # Errors
/// [`MeshError::NotReadable`], [`MeshError::WithoutPositions`].
pub(crate) fn positions_of_asset(mesh: &Mesh) -> Result<Vec<Vec3>, MeshError> {
    // The renderer would soon take its vertices.
    if !mesh.asset_usage.contains(RenderAssetUsages::MAIN_WORLD) {
        return Err(MeshError::NotReadable);
    }
    vectors(attribute_of(mesh, Mesh::ATTRIBUTE_POSITION)?).ok_or(MeshError::WithoutPositions)
}

/// The values of an attribute of three numbers each.
fn vectors(values: Option<&VertexAttributeValues>) -> Option<Vec<Vec3>> {
    let values = values?.as_float3()?.iter();
    Some(values.copied().map(Vec3::from).collect())
}

/// The joints and weights of each vertex of a skinned mesh; `None` for a mesh without joint indices and weights.
///
/// # Errors
/// [`MeshError::NotReadable`] for a mesh that is only in the render world.
pub(crate) fn skin_of_asset(mesh: &Mesh) -> Result<Option<Vec<JointWeights>>, MeshError> {
    use VertexAttributeValues::{Float32x4, Uint16x4};
    let joints = attribute_of(mesh, Mesh::ATTRIBUTE_JOINT_INDEX)?;
    let weights = attribute_of(mesh, Mesh::ATTRIBUTE_JOINT_WEIGHT)?;
    let (Some(Uint16x4(joints)), Some(Float32x4(weights))) = (joints, weights) else {
        return Ok(None);
    };
    let each = joints.iter().zip(weights);
    let each = each.map(|(&joints, &weights)| JointWeights { joints, weights });
    Ok(Some(each.collect()))
}

/// The indices of a mesh of that many vertices: one after the other, if it lists none.
///
/// # Errors
/// [`MeshError::NotReadable`].
pub(crate) fn indices_of_asset(mesh: &Mesh, vertices: usize) -> Result<Vec<u32>, MeshError> {
    let indices = match mesh.try_indices_option() {
        Ok(indices) => indices,
        Err(MeshAccessError::NotFound) => None,
        Err(_) => return Err(MeshError::NotReadable),
    };
    Ok(match indices {
        Some(indices) => indices.iter().map(|index| index as u32).collect(),
        None => (0..vertices as u32).collect(),
    })
}

/// The triangles of a mesh, by its vertices.
fn triangles(mesh: &Mesh, vertices: usize) -> Result<Vec<[u32; 3]>, MeshError> {
    let indices = indices_of_asset(mesh, vertices)?;
    match mesh.primitive_topology() {
        PrimitiveTopology::TriangleList => {
            let (triangles, left) = indices.as_chunks::<3>();
            let count = indices.len();
            let error = MeshError::IndexCount { indices: count };
            left.is_empty().then(|| triangles.to_vec()).ok_or(error)
        }
        PrimitiveTopology::TriangleStrip => {
            let triangles = indices.array_windows::<3>().enumerate();
            // Every second triangle of a strip has the opposite winding order.
            let turned = |(index, &[a, b, c]): (usize, &[u32; 3])| {
                if index % 2 == 0 { [a, b, c] } else { [b, a, c] }
            };
            Ok(triangles.map(turned).collect())
        }
        topology => Err(MeshError::Topology {
            topology: format!("{topology:?}"),
        }),
    }
}

/// Up to four numbers for each vertex, for numeric formats.
fn numbers(values: &VertexAttributeValues) -> Option<Vec<[f32; 4]>> {
    fn filled<const N: usize>(values: &[[f32; N]]) -> Vec<[f32; 4]> {
        let fill =
            |value: &[f32; N]| std::array::from_fn(|at| value.get(at).copied().unwrap_or(0.0));
        values.iter().map(fill).collect()
    }
    fn shares<T: Copy + Into<f32>>(values: &[[T; 4]], most: f32) -> Vec<[f32; 4]> {
        let share = |value: &[T; 4]| value.map(|channel| channel.into() / most);
        values.iter().map(share).collect()
    }
    Some(match values {
        VertexAttributeValues::Float32(values) => filled(values.as_chunks::<1>().0),
        VertexAttributeValues::Float32x2(values) => filled(values),
        VertexAttributeValues::Float32x3(values) => filled(values),
        VertexAttributeValues::Float32x4(values) => filled(values),
        VertexAttributeValues::Unorm8x4(values) => shares(values, 255.0),
        VertexAttributeValues::Unorm16x4(values) => shares(values, 65535.0),
        _ => return None,
    })
}
