//! Meshes that the tests make, and short ways to ask cloths that are made from them.

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_drape::{plugin::ClothBuilt, prelude::*};

use crate::support::*;

/// An asset of triangles.
pub fn asset(positions: &[Vec3], triangles: &[[u32; 3]]) -> Mesh {
    let positions: Vec<_> = positions.iter().map(Vec3::to_array).collect();
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_indices(Indices::U32(triangles.as_flattened().to_vec()))
}

/// A lying sheet of `columns` × `rows` vertices, 0.1 m apart, along +x and +z: it faces up. Vertex (row, column) has the
/// number row × columns + column.
pub fn sheet(columns: u32, rows: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let vertices = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let positions = vertices.map(|(row, column)| Vec3::new(column as f32, 0.0, row as f32) * 0.1);
    let cells = (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| (row, column)));
    let triangles = cells.flat_map(|(row, column)| {
        let a = row * columns + column;
        let (b, c, d) = (a + 1, a + columns, a + columns + 1);
        [[a, c, b], [b, c, d]]
    });
    (positions.collect(), triangles.collect())
}

/// A sheet as an asset, with its normals up.
pub fn sheet_asset(columns: u32, rows: u32) -> Mesh {
    let (positions, triangles) = sheet(columns, rows);
    let normals = vec![Vec3::Y.to_array(); positions.len()];
    asset(&positions, &triangles).with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
}

/// Pins the edge of a sheet that is on the x-axis.
pub fn by_its_edge() -> Pins {
    Pins::new([Pin::at_rest(|place| place.z < 0.01)])
}

pub fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

pub fn meshes(app: &App) -> &Assets<Mesh> {
    app.world().resource()
}

/// Spawns a cloth of an asset.
pub fn spawn(app: &mut App, mesh: &Handle<Mesh>, bundle: impl Bundle) -> Entity {
    let cloth = (Cloth::mesh(), Mesh3d(mesh.clone()), bundle);
    app.world_mut().spawn(cloth).id()
}

pub fn fault(app: &App, cloth: Entity) -> Option<ClothError> {
    let fault = app.world().get::<ClothFault>(cloth);
    fault.map(|fault| fault.error.clone())
}

/// The mesh that an entity draws.
pub fn mesh_of(app: &App, entity: Entity) -> Handle<Mesh> {
    app.world().get::<Mesh3d>(entity).expect("a mesh").0.clone()
}

pub fn surface(app: &App, cloth: Entity) -> &std::sync::Arc<Surface> {
    let built = app.world().get::<ClothBuilt>(cloth);
    built.expect("what was built").surface()
}

/// Where the particle of each vertex is; `None` of a vertex that is no particle.
pub fn by_vertex(app: &App, cloth: Entity) -> Vec<Option<Vec3>> {
    let surface = surface(app, cloth);
    let place = |vertex| particles(app, cloth).position(surface.particle_of_vertex(vertex)?);
    (0..surface.vertices()).map(place).collect()
}
