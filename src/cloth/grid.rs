//! The grid of particles that a cloth may be made from.

use bevy::{
    math::{Vec2, Vec3, Vec3Swizzles},
    reflect::{Reflect, std_traits::ReflectDefault},
};
use thiserror::Error;

use super::{
    limits::{FARTHEST, MAX_PARTICLES},
    quantity::{Allowed, QuantityError},
};

/// The plane of a [`Cloth`](crate::cloth::Cloth) at rest, in its entity's frame.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum ClothPlane {
    /// Columns along +x, rows along −y, facing +z: a curtain, a flag.
    #[default]
    Hanging,
    /// Columns along +x, rows along +z, facing +y: a tablecloth, a trampoline.
    Lying,
}

/// The grid of a cloth, before the transform's scale.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
pub struct GridShape {
    /// Particles along the width, at least 2.
    pub columns: u32,
    /// Particles along the height, at least 2.
    pub rows: u32,
    /// Distance between neighbours in a row or column (m).
    pub spacing: f32,
    /// The plane of the cloth at rest.
    pub plane: ClothPlane,
    /// Whether the grid's middle is at the entity's origin; otherwise particle (0, 0) is.
    pub centred: bool,
}

impl GridShape {
    /// (columns − 1) and (rows − 1) × spacing (m).
    pub fn size(&self) -> Vec2 {
        let sides = [self.columns, self.rows].map(|count| count.saturating_sub(1) as f32);
        Vec2::from(sides) * self.spacing
    }

    /// Returns the validated grid under a transform's `scale`.
    ///
    /// # Errors
    /// [`GridError::TooSmall`] or [`GridError::TooLarge`]. [`GridError::Quantity`] for a spacing that is not
    /// positive, not finite, below 10⁻⁹ m, or that makes the cloth larger than 10¹² m.
    pub fn scaled(&self, scale: Vec3) -> Result<ClothGrid, GridError> {
        let Self { columns, rows, .. } = *self;
        if columns < 2 || rows < 2 {
            return Err(GridError::TooSmall { columns, rows });
        }
        Allowed::LENGTH.check("spacing (m)", [self.spacing])?;
        let (axes, along) = match self.plane {
            ClothPlane::Hanging => ([Vec3::X, Vec3::NEG_Y], scale.truncate()),
            ClothPlane::Lying => ([Vec3::X, Vec3::Z], scale.xz()),
        };
        let spacing = self.spacing * along;
        ClothGrid::new([columns, rows], spacing, axes, scale, self.centred)
    }
}

/// The reason why a grid can't be built.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum GridError {
    /// Fewer than two columns or rows.
    #[error("a cloth needs at least 2 columns and 2 rows, not {columns} × {rows}")]
    TooSmall {
        /// Particles along the width.
        columns: u32,
        /// Particles along the height.
        rows: u32,
    },
    /// More particles than [`MAX_PARTICLES`], or a product that overflows.
    #[error("{columns} × {rows} particles exceed the maximum of {MAX_PARTICLES} for a cloth")]
    TooLarge {
        /// Particles along the width.
        columns: u32,
        /// Particles along the height.
        rows: u32,
    },
    /// Rows and columns were requested of a cloth that was not made from a grid.
    #[error("the cloth is a mesh, which has neither rows nor columns")]
    NotAGrid,
    /// Its spacing is out of range.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
}

/// A validated grid. Springs, trees and meshes are built from it.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
pub struct ClothGrid {
    columns: u32,
    rows: u32,
    /// Distance along the width and the height (m), scaled; negative under a mirroring scale.
    spacing: Vec2,
    /// The directions along a row and down a column, of length 1.
    axes: [Vec3; 2],
    /// The transform's scale that is in it.
    scale: Vec3,
    /// How far from particle (0, 0) the frame's origin is, along the width and the height (m).
    origin: Vec2,
}

impl ClothGrid {
    /// A grid with this scaled spacing (m) along its axes.
    ///
    /// # Errors
    /// [`GridError::TooLarge`] or [`GridError::Quantity`].
    pub(super) fn new(
        [columns, rows]: [u32; 2],
        spacing: Vec2,
        axes: [Vec3; 2],
        scale: Vec3,
        centred: bool,
    ) -> Result<Self, GridError> {
        let count = (columns as usize).checked_mul(rows as usize);
        if count.is_none_or(|count| count > MAX_PARTICLES) {
            return Err(GridError::TooLarge { columns, rows });
        }
        let extent = spacing * Vec2::new(columns as f32, rows as f32);
        let measurable = |length: f32| (1.0e-9..FARTHEST).contains(&length.abs());
        if !(measurable(spacing.x) && measurable(spacing.y) && measurable(extent.length())) {
            return Err(GridError::Quantity(QuantityError {
                quantity: "spacing × scale (m)",
                expected: "at least 10⁻⁹, and the cloth smaller than 10¹² m",
                value: spacing.abs().min_element(),
            }));
        }
        let middle = Vec2::new(columns as f32 - 1.0, rows as f32 - 1.0) * spacing / 2.0;
        Ok(Self {
            columns,
            rows,
            spacing,
            axes,
            scale,
            origin: if centred { middle } else { Vec2::ZERO },
        })
    }

    /// Particles along the width.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Particles along the height.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Distance between neighbours along the width and the height (m), positive.
    pub fn spacing(&self) -> Vec2 {
        self.spacing.abs()
    }

    /// Distance between opposite corners at rest (m).
    pub fn diagonal(&self) -> f32 {
        let sides = Vec2::new(self.columns as f32 - 1.0, self.rows as f32 - 1.0);
        (sides * self.spacing()).length()
    }

    /// Half of the thickness of a rope (m), with the transform's scale; `None` if the grid is no rope.
    pub fn rope_radius(&self) -> Option<f32> {
        (self.rows == 1).then(|| self.spacing().y / 4.0)
    }

    /// The same, without the transform's scale.
    #[cfg(feature = "mesh")]
    pub(crate) fn unscaled_rope_radius(&self) -> Option<f32> {
        Some(self.rope_radius()? / mean(self.scale))
    }

    /// The transform's scale that is in it.
    pub(crate) fn scale(&self) -> Vec3 {
        self.scale
    }

    /// Distance at rest to the particle that is some rows down and columns across (m).
    pub(crate) fn step_length(&self, (down, across): (u32, i32)) -> f32 {
        (self.spacing() * Vec2::new(across as f32, down as f32)).length()
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Whether the grid has no particles, as before the first tick.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// `row × columns + column` (paper, equation 1).
    pub fn index(&self, row: u32, column: u32) -> u32 {
        row * self.columns + column
    }

    /// Position of a particle at rest, in the cloth's frame (m).
    pub fn rest_position(&self, row: u32, column: u32) -> Vec3 {
        let place = Vec2::new(column as f32, row as f32) * self.spacing - self.origin;
        self.axes[0] * place.x + self.axes[1] * place.y
    }

    /// The normal of the cloth at rest, of length 1.
    pub fn normal(&self) -> Vec3 {
        self.axes[1].cross(self.axes[0])
    }

    /// All particles as (row, column), in the order of their indices.
    pub fn cells(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let columns = self.columns;
        (0..self.rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
    }

    /// A particle's share of the cloth's area (m²). It is half a cell on a border and a quarter in a corner, so that
    /// the particles' masses add up to density × area.
    pub fn tributary_area(&self, row: u32, column: u32) -> f32 {
        let is_end = |index: u32, count: u32| index == 0 || index + 1 == count;
        let share = |index, count| if is_end(index, count) { 0.5 } else { 1.0 };
        let spacing = self.spacing();
        spacing.x * share(column, self.columns) * spacing.y * share(row, self.rows)
    }

    /// Two triangles for each cell, as particle indices, counter-clockwise seen from the front (paper, Figure 1).
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        let grid = *self;
        (0..grid.rows.saturating_sub(1)).flat_map(move |row| {
            (0..grid.columns.saturating_sub(1)).flat_map(move |column| {
                let (a, b) = (grid.index(row, column), grid.index(row, column + 1));
                let (c, d) = (grid.index(row + 1, column), grid.index(row + 1, column + 1));
                [[a, c, b], [b, c, d]]
            })
        })
    }
}

/// The mean scale of three axes, by which a rope's radius grows.
pub(super) fn mean(scale: Vec3) -> f32 {
    scale.abs().element_sum() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;

    #[test]
    fn lies_from_the_origin_to_width_and_minus_height() {
        let cloth = Cloth::new(5, 3, 0.5);
        let grid = cloth.grid(Vec3::ONE).expect("a valid grid");
        assert_eq!(grid.rest_position(0, 0), Vec3::ZERO);
        assert_eq!(grid.rest_position(2, 4), Vec3::new(2.0, -1.0, 0.0));
        let indices: Vec<u32> = grid.cells().map(|(r, c)| grid.index(r, c)).collect();
        assert_eq!(indices, (0..15).collect::<Vec<_>>());
    }

    /// Lying, it goes along +x and +z; centred, its middle is the origin; scaled, along its own axes.
    #[test]
    fn lies_and_is_centred_as_asked() {
        let scale = Vec3::new(2.0, 3.0, 5.0);
        let rest = |cloth: &Cloth, row, column| {
            let grid = cloth.grid(scale).expect("a valid grid");
            grid.rest_position(row, column)
        };
        let cloth = Cloth::new(5, 3, 0.5);
        assert_eq!(rest(&cloth.clone().lying(), 2, 4), Vec3::new(4.0, 0.0, 5.0));
        assert_eq!(
            rest(&cloth.clone().centred(), 0, 0),
            Vec3::new(-2.0, 1.5, 0.0)
        );
        assert_eq!(rest(&cloth.clone().centred(), 1, 2), Vec3::ZERO);
        let tablecloth = cloth.lying().centred();
        assert_eq!(rest(&tablecloth, 0, 0), Vec3::new(-2.0, 0.0, -2.5));
        assert_eq!(rest(&tablecloth, 2, 4), Vec3::new(2.0, 0.0, 2.5));
    }

    #[test]
    fn areas_add_up_and_triangles_face_forward() {
        for cloth in [Cloth::new(5, 4, 0.5), Cloth::new(5, 4, 0.5).lying()] {
            check_areas_and_triangles(&cloth.grid(Vec3::ONE).expect("a valid grid"));
        }
    }

    fn check_areas_and_triangles(grid: &ClothGrid) {
        let area: f32 = grid.cells().map(|(r, c)| grid.tributary_area(r, c)).sum();
        assert_eq!(area, 2.0 * 1.5);
        let positions: Vec<Vec3> = grid
            .cells()
            .map(|(r, c)| grid.rest_position(r, c))
            .collect();
        let mut triangle_area = 0.0;
        for [a, b, c] in grid.triangles() {
            let [a, b, c] = [a, b, c].map(|index| positions[index as usize]);
            let facing = (b - a).cross(c - a).dot(grid.normal());
            assert!(facing > 0.0);
            triangle_area += facing / 2.0;
        }
        assert_eq!(triangle_area, area);
    }

    #[test]
    fn refuses_what_cannot_be_built() {
        assert!(matches!(
            Cloth::new(1, 8, 0.1).grid(Vec3::ONE),
            Err(GridError::TooSmall {
                columns: 1,
                rows: 8
            })
        ));
        assert!(matches!(
            Cloth::new(u32::MAX, u32::MAX, 0.1).grid(Vec3::ONE),
            Err(GridError::TooLarge { .. })
        ));
        for spacing in [0.0, -0.1, f32::NAN, f32::INFINITY, 1e-30, 1e30] {
            assert!(
                matches!(
                    Cloth::new(8, 8, spacing).grid(Vec3::ONE),
                    Err(GridError::Quantity(_))
                ),
                "spacing {spacing}"
            );
        }
    }
}
