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
pub(super) fn write_mesh(mesh: &mut Mesh, grid: &ClothGrid, drawn: &[Vec3]) {
    if let Ok(VertexAttributeValues::Float32x3(values)) =
        mesh.try_attribute_mut(Mesh::ATTRIBUTE_POSITION)
    {
        values
            .iter_mut()
            .zip(drawn)
            .for_each(|(value, position)| *value = position.to_array());
    }
    let edges = || {
        grid.cells()
            .map(|(row, column)| Edges::at(grid, drawn, row, column))
    };
    if let Ok(VertexAttributeValues::Float32x3(values)) =
        mesh.try_attribute_mut(Mesh::ATTRIBUTE_NORMAL)
    {
        values
            .iter_mut()
            .zip(edges())
            .for_each(|(value, edges)| *value = edges.normal(grid).to_array());
    }
    if let Ok(VertexAttributeValues::Float32x4(values)) =
        mesh.try_attribute_mut(Mesh::ATTRIBUTE_TANGENT)
    {
        values
            .iter_mut()
            .zip(edges())
            .for_each(|(value, edges)| *value = tangent(edges.along, edges.normal(grid)));
    }
}

/// From neighbour to neighbour of a particle: along its row and up its column (m).
struct Edges {
    along: Vec3,
    up: Vec3,
}

impl Edges {
    fn at(grid: &ClothGrid, position: &[Vec3], row: u32, column: u32) -> Self {
        let at = |row, column| position[grid.index(row, column) as usize];
        let (right, below) = (
            (column + 1).min(grid.columns() - 1),
            (row + 1).min(grid.rows() - 1),
        );
        Self {
            along: at(row, right) - at(row, column.saturating_sub(1)),
            up: at(row.saturating_sub(1), column) - at(below, column),
        }
    }

    /// Of the surface through the neighbours.
    fn normal(&self, grid: &ClothGrid) -> Vec3 {
        self.along.cross(self.up).normalize_or(grid.normal())
    }
}

/// The way in which u grows, across the normal; 1 says that normal × tangent is the way in which v shrinks, as Bevy has
/// it for textures with v downwards.
fn tangent(along: Vec3, normal: Vec3) -> [f32; 4] {
    let tangent = along.reject_from_normalized(normal);
    let tangent = tangent.normalize_or(normal.any_orthonormal_vector());
    tangent.extend(1.0).to_array()
}
