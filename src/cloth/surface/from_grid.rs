//! A surface made from a grid.

use bevy::math::{UVec2, Vec3};

use super::{Extent, Spacing, Surface};
use crate::cloth::grid::ClothGrid;

impl Surface {
    /// The surface of a grid.
    pub fn of_grid(grid: &ClothGrid) -> Self {
        let places = grid.cells();
        let rest = places.map(|(row, column)| grid.rest_position(row, column));
        Self::of_placed_grid(grid, rest.collect(), vec![grid.normal()])
    }

    /// The surface of a grid whose particles begin at other places than the grid's (m), with one normal for all, or one for each.
    pub(crate) fn of_placed_grid(grid: &ClothGrid, rest: Vec<Vec3>, normals: Vec<Vec3>) -> Self {
        let spacing = grid.spacing();
        let areas = (grid.cells()).map(|(row, column)| grid.tributary_area(row, column));
        let sides = UVec2::new(grid.columns(), grid.rows()).saturating_sub(UVec2::ONE);
        let of_faces = Extent {
            diagonal: grid.diagonal(),
            area: (sides.as_vec2() * spacing).element_product(),
            particles_across: grid.columns().min(grid.rows()) as usize,
            // Without shear springs, a path follows both sides of a cell.
            face_reach: spacing.element_sum(),
            longest_spring: spacing.length(),
            max_faces: 6,
            pieces: 1,
        };
        let (extent, [shortest, longest]) = match grid.rope_radius() {
            None => (of_faces, [spacing.min_element(), spacing.max_element()]),
            // Neither faces nor distances across.
            Some(radius) => {
                let extent = Extent {
                    area: grid.diagonal() * 2.0 * radius,
                    face_reach: spacing.x,
                    longest_spring: spacing.x,
                    max_faces: 0,
                    ..of_faces
                };
                (extent, [spacing.x; 2])
            }
        };
        Self {
            rest,
            areas: areas.collect(),
            normals,
            scale: grid.scale(),
            spacing: Spacing {
                shortest,
                typical: shortest,
                longest,
            },
            extent,
            grid: Some(*grid),
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;

    #[test]
    fn is_the_grid_in_other_words() {
        let grid = Cloth::new(5, 4, 0.5)
            .grid(Vec3::new(1.0, 2.0, 1.0))
            .expect("a valid grid");
        let surface = Surface::of_grid(&grid);
        let cells: Vec<(u32, u32)> = grid.cells().collect();
        for (index, &(row, column)) in cells.iter().enumerate() {
            assert_eq!(
                surface.rest_positions()[index],
                grid.rest_position(row, column)
            );
            assert_eq!(surface.area_of(index), grid.tributary_area(row, column));
            assert_eq!(surface.particle_of_vertex(index), Some(index));
            let owned = surface.faces().of(index as u32);
            let begins_cell = row < 3 && column < 4;
            assert_eq!(owned.len(), if begins_cell { 2 } else { 0 });
            let neighbours: Vec<u32> = surface
                .graph()
                .of(index as u32)
                .iter()
                .map(|near| near.0)
                .collect();
            let expected: Vec<u32> = cells
                .iter()
                .filter(|cell| **cell != (row, column))
                .filter(|cell| cell.0.abs_diff(row) <= 1 && cell.1.abs_diff(column) <= 1)
                .map(|cell| grid.index(cell.0, cell.1))
                .collect();
            assert_eq!(neighbours, expected, "ascending, all eight");
        }
        assert_eq!(surface.triangles(), grid.triangles().collect::<Vec<_>>());
        assert_eq!(surface.area(), 2.0 * 3.0);
        assert_eq!(surface.spacing().longest, 1.0);
        assert_eq!(surface.particle_of_vertex(20), None);
    }
}
