//! Lazily computed properties of a grid's surface.

use bevy::math::{DVec2, Vec2};

use super::{faces::Faces, flat::Flat, graph::Graph};
use crate::cloth::grid::ClothGrid;

/// From (0, 0) at particle (0, 0) to (1, 1) at the last one.
pub(super) fn uvs(grid: &ClothGrid) -> Vec<Vec2> {
    let last = Vec2::new((grid.columns() - 1) as f32, (grid.rows() - 1) as f32).max(Vec2::ONE);
    let uv = |(row, column): (u32, u32)| Vec2::new(column as f32, row as f32) / last;
    grid.cells().map(uv).collect()
}

/// Two faces for each cell, owned by its first particle.
pub(super) fn faces(grid: &ClothGrid) -> Faces {
    let begins_cell =
        |(row, column): &(u32, u32)| row + 1 < grid.rows() && column + 1 < grid.columns();
    let cells = || grid.cells().filter(begins_cell);
    let owners = || cells().flat_map(|(row, column)| [grid.index(row, column); 2]);
    Faces::new(grid.len(), || owners().zip(grid.triangles()))
}

/// Neighbours in rows, columns and along both diagonals.
pub(super) fn graph(grid: &ClothGrid) -> Graph {
    let steps = [(0, 1), (1, -1), (1, 0), (1, 1)];
    let edges: Vec<([u32; 2], f32)> = grid
        .cells()
        .flat_map(move |(row, column)| {
            steps.into_iter().filter_map(move |(down, across)| {
                let (below, beside) = (row + down, column.checked_add_signed(across)?);
                let exists = below < grid.rows() && beside < grid.columns();
                exists.then(|| {
                    let ends = [grid.index(row, column), grid.index(below, beside)];
                    (ends, grid.step_length((down, across)))
                })
            })
        })
        .collect();
    Graph::new(grid.len(), edges.into_iter())
}

/// The plane along its columns and rows, from particle (0, 0).
pub(super) fn flat(grid: &ClothGrid) -> Flat {
    let spacing = grid.spacing().as_dvec2();
    let place = |(row, column): (u32, u32)| DVec2::new(f64::from(column), f64::from(row)) * spacing;
    Flat {
        places: grid.cells().map(place).collect(),
        has_chains: true,
    }
}
