//! One rectangle, made of a grid or of triangles that lie in different ways.

use bevy::math::Vec3;
use bevy_drape::cloth::{Cloth, Surface, TriangleMesh};

use crate::{measure::Random, meshes};

/// The structure of a rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Made {
    Grid,
    /// Two triangles a cell, with the same diagonal everywhere.
    Regular,
    /// Neighbouring cells have the other diagonal.
    Alternating,
    /// Any diagonal, and vertices moved by up to 0.3 spacings.
    Random,
    /// A Delaunay triangulation of vertices moved by up to 0.3 spacings.
    Delaunay,
}

impl Made {
    pub const ALL: [Self; 5] = [
        Self::Grid,
        Self::Regular,
        Self::Alternating,
        Self::Random,
        Self::Delaunay,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Regular => "regular mesh",
            Self::Alternating => "alternating diagonals",
            Self::Random => "random diagonals, moved by 0.3",
            Self::Delaunay => "Delaunay, moved by 0.3",
        }
    }

    /// From (0, 0, 0) to (width, −height, 0), with the triangles that it was made from.
    pub fn surface(self, [columns, rows]: [u32; 2], spacing: f32) -> (Surface, TriangleMesh) {
        let [width, height] = [columns, rows].map(|count| (count - 1) as f32 * spacing);
        let mesh = match self {
            Self::Grid => {
                let cloth = Cloth::new(columns, rows, spacing);
                let surface = cloth.surface(Vec3::ONE).expect("a grid");
                return (surface, TriangleMesh::default());
            }
            Self::Regular => meshes::regular(columns, rows, spacing),
            Self::Delaunay => meshes::irregular(width, height, spacing, 0.3),
            Self::Alternating | Self::Random => self.of_diagonals([columns, rows], spacing),
        };
        let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
        (surface, mesh)
    }

    fn of_diagonals(self, [columns, rows]: [u32; 2], spacing: f32) -> TriangleMesh {
        let [width, height] = [columns, rows].map(|count| (count - 1) as f32 * spacing);
        let jitter = if self == Self::Random { 0.3 } else { 0.0 };
        let mut mesh = meshes::irregular(width, height, spacing, jitter);
        let mut random = Random(12_345);
        mesh.triangles.clear();
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let a = row * columns + column;
                let (b, c, d) = (a + 1, a + columns, a + columns + 1);
                let is_other = match self {
                    Self::Random => random.below(2) == 1,
                    _ => (row + column) % 2 == 1,
                };
                mesh.triangles.extend(if is_other {
                    [[a, c, d], [a, d, b]]
                } else {
                    [[a, c, b], [b, c, d]]
                });
            }
        }
        mesh
    }
}
