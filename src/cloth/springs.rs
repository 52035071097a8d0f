//! The springs between the particles, sorted by colour.

use std::ops::Range;

use bevy::{math::Vec2, reflect::Reflect};

use super::{ClothGrid, ClothMaterial};

/// What a spring resists.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SpringKind {
    /// Stretch: neighbours in a row or column.
    Structural,
    /// Shear: neighbours along a diagonal.
    Shear,
    /// Bending: every second particle of a row or column.
    Bend,
}

/// A run of springs no two of which share a particle, so that their order makes no difference.
#[derive(Reflect, Debug, Clone, PartialEq)]
pub struct Colour {
    /// What its springs resist.
    pub kind: SpringKind,
    /// Which springs they are.
    pub springs: Range<usize>,
}

/// A cloth's springs, in columns, one colour after the other.
///
/// The order is the solver's stability: colour by colour over the whole cloth holds at every size, row by row
/// blows up.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
pub struct Springs {
    colours: Vec<Colour>,
    ends: Vec<[u32; 2]>,
    rest_length: Vec<f32>,
    compliance: Vec<f32>,
}

impl Springs {
    /// Structural, shear and bend springs of `grid`. A strip's compliance follows from its length over its
    /// width ([`ClothMaterial`]); a strip on a border is half as wide. Kinds whose compliance is infinite are
    /// left out.
    pub fn of_grid(grid: &ClothGrid, material: &ClothMaterial) -> Self {
        use SpringKind::{Bend, Shear, Structural};
        let mut springs = Self::default();
        for (kind, compliance, steps) in [
            (Structural, material.stretch_compliance, [(0, 1), (1, 0)]),
            (Shear, material.shear_compliance, [(1, 1), (1, -1)]),
            (Bend, material.bend_compliance, [(0, 2), (2, 0)]),
        ] {
            if compliance.is_infinite() {
                continue;
            }
            for half in 0..2 {
                for step in steps {
                    springs.add_colour(grid, kind, compliance, step, half);
                }
            }
        }
        springs
    }

    /// Adds springs from particles to those `step` (rows, columns) on. Along the step, the springs that start in
    /// the first half of every 2 × step particles are one colour, the others the next.
    fn add_colour(
        &mut self,
        grid: &ClothGrid,
        kind: SpringKind,
        compliance: f32,
        step: (u32, i32),
        half: u32,
    ) {
        let (down, across) = step;
        let spacing = grid.spacing();
        let rest_length = (spacing * Vec2::new(across as f32, down as f32)).length();
        // Of a strip on a border half of the width is missing.
        let narrowed = |index: u32, count: u32| {
            if index == 0 || index + 1 == count {
                2.0
            } else {
                1.0
            }
        };
        let start = self.ends.len();
        for (row, column) in grid.cells() {
            let place = match step {
                (0, across) => column / across.unsigned_abs(),
                (down, _) => row / down,
            };
            let (to_row, to_column) = (row + down, column.wrapping_add_signed(across));
            if place % 2 != half || to_row >= grid.rows() || to_column >= grid.columns() {
                continue;
            }
            let length_over_width = match step {
                (0, _) => rest_length / spacing.y * narrowed(row, grid.rows()),
                (_, 0) => rest_length / spacing.x * narrowed(column, grid.columns()),
                _ => 1.0,
            };
            self.ends
                .push([grid.index(row, column), grid.index(to_row, to_column)]);
            self.rest_length.push(rest_length);
            self.compliance.push(compliance * length_over_width);
        }
        let springs = start..self.ends.len();
        if !springs.is_empty() {
            self.colours.push(Colour { kind, springs });
        }
    }

    /// Number of springs.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no spring, as before the first tick.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The colours, in the order in which they are swept.
    pub fn colours(&self) -> &[Colour] {
        &self.colours
    }

    /// Both particles of each spring.
    pub fn ends(&self) -> &[[u32; 2]] {
        &self.ends
    }

    /// Rest length of each spring (m).
    pub fn rest_length(&self) -> &[f32] {
        &self.rest_length
    }

    /// Compliance of each spring (m/N).
    pub fn compliance(&self) -> &[f32] {
        &self.compliance
    }

    /// Whether there are springs of `kind`.
    pub fn has(&self, kind: SpringKind) -> bool {
        self.colours.iter().any(|colour| colour.kind == kind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;
    use bevy::math::Vec3;
    use std::collections::HashSet;

    #[test]
    fn colours_share_no_particle_and_no_spring_is_missing_or_twice() {
        for (columns, rows) in [(2, 2), (2, 3), (3, 2), (5, 7), (8, 8), (13, 4), (16, 16)] {
            let grid = Cloth::new(columns, rows, 0.1)
                .grid(Vec3::ONE)
                .expect("a sound grid");
            let springs = Springs::of_grid(&grid, &ClothMaterial::COTTON);
            let mut seen = HashSet::new();
            for colour in springs.colours() {
                let mut particles = HashSet::new();
                for index in colour.springs.clone() {
                    let [a, b] = springs.ends()[index];
                    assert!(
                        particles.insert(a) && particles.insert(b),
                        "{columns} × {rows}: {colour:?}"
                    );
                    assert!(seen.insert((a.min(b), a.max(b))));
                }
            }
            let (c, r) = (columns as usize, rows as usize);
            let structural = (c - 1) * r + c * (r - 1);
            let shear = 2 * (c - 1) * (r - 1);
            let bend = c.saturating_sub(2) * r + c * r.saturating_sub(2);
            assert_eq!(springs.len(), structural + shear + bend);
            assert_eq!(seen.len(), springs.len());
        }
    }

    #[test]
    fn rest_lengths_are_those_of_the_cloth_at_rest() {
        let grid = Cloth::new(6, 5, 0.25)
            .grid(Vec3::new(2.0, -3.0, 1.0))
            .expect("a sound grid");
        let springs = Springs::of_grid(&grid, &ClothMaterial::COTTON);
        let positions: Vec<Vec3> = grid
            .cells()
            .map(|(r, c)| grid.rest_position(r, c))
            .collect();
        for (&[a, b], &rest_length) in springs.ends().iter().zip(springs.rest_length()) {
            let length = positions[a as usize].distance(positions[b as usize]);
            assert!(
                (length - rest_length).abs() < 1e-5,
                "{length} {rest_length}"
            );
        }
    }

    #[test]
    fn an_infinite_compliance_leaves_its_springs_out() {
        let grid = Cloth::new(6, 5, 0.25)
            .grid(Vec3::ONE)
            .expect("a sound grid");
        let material = ClothMaterial {
            shear_compliance: f32::INFINITY,
            bend_compliance: f32::INFINITY,
            ..ClothMaterial::COTTON
        };
        let springs = Springs::of_grid(&grid, &material);
        assert!(springs.has(SpringKind::Structural));
        assert!(!springs.has(SpringKind::Shear) && !springs.has(SpringKind::Bend));
    }
}
