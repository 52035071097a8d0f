//! Changes of a grid's resolution: the cloth stays where it is.

use bevy::math::Vec3;

use crate::cloth::{ClothGrid, ClothParticles, ParticleError};

/// Largest difference of corners, as a fraction of the diagonal: more than the rounding of a spacing that is a
/// quotient.
const ALIKE: f32 = 1.0e-4;

/// Whether two grids are the same rectangle at rest.
pub(crate) fn is_same_rectangle(a: &ClothGrid, b: &ClothGrid) -> bool {
    let corners = |grid: &ClothGrid| {
        let (row, column) = (grid.rows() - 1, grid.columns() - 1);
        [(0, 0), (0, column), (row, 0)].map(|(row, column)| grid.rest_position(row, column))
    };
    let mut pairs = corners(a).into_iter().zip(corners(b));
    pairs.all(|(of_a, of_b)| of_a.distance(of_b) <= ALIKE * a.diagonal())
}

/// Puts the particles of a grid, `new`, where the surface of the particles `old` of another is, and has them move as it does: bilinear
/// in rows and columns. Between, `relax` may move them: where a surface is twisted, the mean of its chains is shorter than they are.
///
/// # Errors
/// [`ParticleError::NoSuchParticle`] if particles and grids are not each other's.
pub(crate) fn resample(
    (old, from): (&ClothParticles, &ClothGrid),
    (new, to): (&mut ClothParticles, &ClothGrid),
    relax: impl FnOnce(&mut ClothParticles),
) -> Result<(), ParticleError> {
    let between = |(row, column): (u32, u32), of: fn(&ClothParticles, usize) -> Option<Vec3>| {
        let (row, down) = place(row, to.rows(), from.rows());
        let (column, across) = place(column, to.columns(), from.columns());
        let of = |row, column| of(old, from.index(row, column) as usize).unwrap_or_default();
        let in_row = |row| of(row, column).lerp(of(row, column + 1), across);
        in_row(row).lerp(in_row(row + 1), down)
    };
    let index = |(row, column): (u32, u32)| to.index(row, column) as usize;
    for cell in to.cells() {
        new.set_position(index(cell), between(cell, ClothParticles::position))?;
    }
    relax(new);
    for cell in to.cells() {
        new.set_velocity(index(cell), between(cell, ClothParticles::velocity))?;
    }
    Ok(())
}

/// Where one of `of` rows or columns is among `from` of another grid: the one before it, never the last, and how far from there to the
/// next.
fn place(index: u32, of: u32, from: u32) -> (u32, f32) {
    // The only row of a rope.
    if of == 1 || from == 1 {
        return (0, 0.0);
    }
    let at = index as f32 * (from - 1) as f32 / (of - 1) as f32;
    let before = (at as u32).min(from - 2);
    (before, at - before as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::{Cloth, ClothMaterial, Surface};

    fn grid(columns: u32, rows: u32) -> (ClothParticles, ClothGrid) {
        let cloth = Cloth::new(columns, rows, 1.2 / (columns - 1) as f32);
        let grid = cloth.grid(Vec3::ONE).expect("a valid grid");
        let surface = Surface::of_grid(&grid);
        let particles = ClothParticles::at_rest(&surface, &ClothMaterial::COTTON);
        (particles.expect("a valid material"), grid)
    }

    /// A plane that is sheared and turns is one between its particles, too: each new one is on it and moves with it, to a rounding.
    #[test]
    fn what_is_bilinear_is_kept_at_any_resolution() {
        let moved = |rest: Vec3| Vec3::new(rest.x, 0.5 * rest.y, rest.x - 0.3 * rest.y + 2.0);
        let speed = |rest: Vec3| Vec3::new(rest.y, 1.0, 3.0 * rest.x);
        let (mut old, from) = grid(13, 13);
        for (row, column) in from.cells() {
            let rest = from.rest_position(row, column);
            old.set_position((row, column), moved(rest))
                .and_then(|()| old.set_velocity((row, column), speed(rest)))
                .expect("it exists");
        }
        for side in [2, 9, 13, 32] {
            let (mut new, to) = grid(side, side);
            assert!(is_same_rectangle(&from, &to));
            resample((&old, &from), (&mut new, &to), |_| {}).expect("particles of the grids");
            for (row, column) in to.cells() {
                let rest = to.rest_position(row, column);
                let position = new.position((row, column)).expect("it exists");
                let velocity = new.velocity((row, column)).expect("it exists");
                assert!(
                    position.distance(moved(rest)) < 1.0e-5,
                    "{side}: {position}"
                );
                assert!(
                    velocity.distance(speed(rest)) < 1.0e-4,
                    "{side}: {velocity}"
                );
            }
        }
        assert!(!is_same_rectangle(&from, &grid(13, 12).1));
    }
}
