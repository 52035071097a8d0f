//! The drawn surface: vertices, UVs, normals and tangents of a grid.

use bevy::{
    asset::RenderAssetUsages,
    math::Vec3,
    mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues},
};

use crate::cloth::ClothGrid;

/// The cloth at rest, with room for what changes. UVs go from (0, 0) in particle (0, 0) to (1, 1) in the last.
pub(super) fn flat_mesh(grid: &ClothGrid) -> Mesh {
    let uv = |row: u32, column: u32| {
        [
            column as f32 / (grid.columns() - 1) as f32,
            row as f32 / (grid.rows() - 1) as f32,
        ]
    };
    let positions: Vec<_> = grid
        .cells()
        .map(|(r, c)| grid.rest_position(r, c).to_array())
        .collect();
    let uvs: Vec<_> = grid.cells().map(|(row, column)| uv(row, column)).collect();
    let normals = vec![grid.normal().to_array(); grid.len()];
    let tangents = vec![tangent(Vec3::X, grid.normal()); grid.len()];
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, tangents)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_indices(Indices::U32(grid.triangles().flatten().collect()))
}

/// Writes where the particles are drawn into a mesh, with normals and, if it still has them, tangents.
pub(super) fn write_mesh(
    mesh: &mut Mesh,
    grid: &ClothGrid,
    drawn: &[Vec3],
    normals: &mut Vec<Vec3>,
) {
    if let Ok(VertexAttributeValues::Float32x3(values)) =
        mesh.try_attribute_mut(Mesh::ATTRIBUTE_POSITION)
    {
        for (value, position) in values.iter_mut().zip(drawn) {
            *value = position.to_array();
        }
    }
    normals.clear();
    for_each_row(grid, drawn, |above, row, below| {
        for column in 0..row.len() {
            let up = above[column] - below[column];
            let normal = along(row, column).cross(up);
            normals.push(normal.normalize_or(grid.normal()));
        }
    });
    if let Ok(VertexAttributeValues::Float32x3(values)) =
        mesh.try_attribute_mut(Mesh::ATTRIBUTE_NORMAL)
    {
        for (value, normal) in values.iter_mut().zip(&*normals) {
            *value = normal.to_array();
        }
    }
    if let Ok(VertexAttributeValues::Float32x4(values)) =
        mesh.try_attribute_mut(Mesh::ATTRIBUTE_TANGENT)
    {
        let mut vertices = values.iter_mut().zip(&*normals);
        for_each_row(grid, drawn, |_, row, _| {
            for (column, (value, normal)) in vertices.by_ref().take(row.len()).enumerate() {
                *value = tangent(along(row, column), *normal);
            }
        });
    }
}

/// Visits each row with the one above and the one below it; beside a border with itself.
fn for_each_row(
    grid: &ClothGrid,
    places: &[Vec3],
    mut visit: impl FnMut(&[Vec3], &[Vec3], &[Vec3]),
) {
    let columns = grid.columns() as usize;
    let row = |row: usize| &places[row * columns..(row + 1) * columns];
    let last = grid.rows() as usize - 1;
    for index in 0..=last {
        let (above, below) = (index.saturating_sub(1), (index + 1).min(last));
        visit(row(above), row(index), row(below));
    }
}

/// From one neighbour in a row to the other (m).
fn along(row: &[Vec3], column: usize) -> Vec3 {
    row[(column + 1).min(row.len() - 1)] - row[column.saturating_sub(1)]
}

/// The way in which u grows, across the normal; 1 says that normal × tangent is the way in which v shrinks, as Bevy has
/// it for textures with v downwards.
fn tangent(along: Vec3, normal: Vec3) -> [f32; 4] {
    let tangent = along.reject_from_normalized(normal);
    let tangent = tangent.normalize_or(normal.any_orthonormal_vector());
    tangent.extend(1.0).to_array()
}
