//! Surfaces of meshes: what is one particle, which way it faces, and how the grid's own triangles fare as a mesh.

mod torn;

use bevy::math::Vec3;

use super::*;
use crate::cloth::recipe::Cloth;

/// A unit square of two triangles, each with corners of its own.
fn square() -> TriangleMesh {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
    TriangleMesh {
        positions: [0, 1, 2, 0, 2, 3].map(|corner| corners[corner]).into(),
        triangles: vec![[0, 2, 1], [3, 5, 4]],
        ..TriangleMesh::default()
    }
}

#[test]
fn vertices_in_one_place_are_one_particle() {
    let surface = Surface::of_mesh(&square(), 0.0, Vec3::ONE).expect("a surface");
    assert_eq!((surface.len(), surface.vertices()), (4, 6));
    assert_eq!(surface.particle_of_vertex(0), surface.particle_of_vertex(3));
    assert_eq!(surface.particle_of_vertex(2), surface.particle_of_vertex(4));
    assert_eq!(surface.particle_of_vertex(6), None);
    assert!((surface.area() - 1.0).abs() < 1.0e-6);
    assert!((0..4).all(|particle| surface.normal_of(particle).dot(Vec3::Y) > 0.999));
    assert!(surface.flat().is_some());
}

/// The triangles of a grid, given as a mesh, are the same surface, whatever the order of its particles.
#[test]
fn a_grids_triangles_are_its_surface() {
    let scale = Vec3::new(1.0, 2.0, 1.0);
    let grid = Cloth::new(7, 5, 0.5).grid(Vec3::ONE).expect("a valid grid");
    let mesh = TriangleMesh {
        positions: grid
            .cells()
            .map(|(row, column)| grid.rest_position(row, column))
            .collect(),
        triangles: grid.triangles().collect(),
        ..TriangleMesh::default()
    };
    let of_mesh = Surface::of_mesh(&mesh, 1.0e-5, scale).expect("a surface");
    let grid = Cloth::new(7, 5, 0.5).grid(scale).expect("a valid grid");
    let of_grid = Surface::of_grid(&grid);
    assert_eq!(of_mesh.len(), of_grid.len());
    assert_eq!(of_mesh.triangles().len(), of_grid.triangles().len());
    assert!((of_mesh.area() - of_grid.area()).abs() < 1.0e-5);
    assert_eq!(of_mesh.diagonal(), of_grid.diagonal());
    for index in 0..of_grid.len() {
        let particle = of_mesh.particle_of_vertex(index).expect("a particle");
        let place = of_mesh.rest_positions()[particle];
        assert_eq!(place, of_grid.rest_positions()[index]);
        assert!(of_mesh.normal_of(particle).dot(of_grid.normal_of(index)) > 0.999);
    }
}

#[test]
fn what_is_no_surface_is_refused() {
    let refused = |change: fn(&mut TriangleMesh)| {
        let mut mesh = square();
        change(&mut mesh);
        Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect_err("no surface")
    };
    assert!(matches!(
        refused(|mesh| mesh.positions[4].y = f32::NAN),
        MeshError::VertexNotFinite { vertex: 4, .. }
    ));
    assert!(matches!(
        refused(|mesh| mesh.triangles[1][2] = 6),
        MeshError::TriangleOutOfRange {
            triangle: 1,
            vertices: 6,
            ..
        }
    ));
    assert!(matches!(
        refused(|mesh| mesh.triangles.clear()),
        MeshError::WithoutArea { triangles: 0 }
    ));
    assert!(matches!(
        refused(|mesh| mesh.positions.fill(Vec3::X)),
        MeshError::WithoutArea { triangles: 2 }
    ));
}
