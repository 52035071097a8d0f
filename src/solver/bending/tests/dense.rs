//! What dense matrices in f64 make of a grid's chains and cells.

use bevy::math::DVec3;

use super::RIGIDITY;
use crate::cloth::{ClothGrid, ClothParticles};

/// Solves a dense symmetric system in place of its right side.
pub(super) fn solve_dense(matrix: &mut [Vec<f64>], right: &mut [DVec3]) {
    let count = right.len();
    for pivot in 0..count {
        let (head, tail) = matrix.split_at_mut(pivot + 1);
        let own = &head[pivot];
        for (row, numbers) in tail.iter_mut().enumerate() {
            let share = numbers[pivot] / own[pivot];
            if share != 0.0 {
                for column in pivot..count {
                    numbers[column] -= share * own[column];
                }
                let moved = right[pivot] * share;
                right[pivot + 1 + row] -= moved;
            }
        }
    }
    for row in (0..count).rev() {
        let mut sum = right[row];
        for column in row + 1..count {
            sum -= matrix[row][column] * right[column];
        }
        right[row] = sum / matrix[row][row];
    }
}

/// Particles and their shares of what is bent or twisted.
type Stencil = Vec<(usize, f64)>;

/// Families in the order in which they are solved: what of each is bent or twisted, and its k (N/m).
pub(super) fn families(grid: &ClothGrid) -> [Vec<(Stencil, f64)>; 4] {
    let (rows, columns) = (grid.rows() as usize, grid.columns() as usize);
    let (wide, high) = (f64::from(grid.spacing().x), f64::from(grid.spacing().y));
    let rigidity = f64::from(RIGIDITY);
    let index = |row: usize, column: usize| row * columns + column;
    let [mut even, mut odd, mut down, mut across] = [const { Vec::new() }; 4];
    for row in 0..rows {
        for column in 0..columns {
            let (has_sides, has_ends) = (
                (1..columns - 1).contains(&column),
                (1..rows - 1).contains(&row),
            );
            let chain = |width: f64, spacing: f64, beside: usize| {
                let own = index(row, column);
                let bent = vec![(own - beside, 1.0), (own, -2.0), (own + beside, 1.0)];
                (bent, rigidity * width / spacing.powi(3))
            };
            if has_sides {
                across.push(chain(if has_ends { high } else { high / 2.0 }, wide, 1));
            }
            if has_ends {
                down.push(chain(
                    if has_sides { wide } else { wide / 2.0 },
                    high,
                    columns,
                ));
            }
            if row + 1 < rows && column + 1 < columns {
                let corners = [(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)];
                let twisted = corners
                    .map(|(below, right, share)| (index(row + below, column + right), share));
                let family = if column % 2 == 0 { &mut even } else { &mut odd };
                family.push((twisted.to_vec(), 2.0 * rigidity / (wide * high)));
            }
        }
    }
    [even, odd, down, across]
}

fn deviation(stencil: &Stencil, places: &[DVec3]) -> DVec3 {
    stencil.iter().map(|&(at, share)| share * places[at]).sum()
}

/// Masses (kg), and where particles will be.
pub(super) fn start(particles: &ClothParticles) -> (Vec<f64>, Vec<DVec3>) {
    let masses = particles
        .inverse_masses()
        .map(|of| 1.0 / f64::from(of))
        .collect();
    let places = particles.positions().zip(particles.displacements());
    let places = places.map(|(place, moved)| place.as_dvec3() + moved.as_dvec3());
    (masses, places.collect())
}

/// How far the forces of each family move particles.
pub(super) fn pushes(grid: &ClothGrid, particles: &ClothParticles, weight: f64) -> [Vec<DVec3>; 4] {
    let (masses, places) = start(particles);
    families(grid).map(|family| {
        let mut moved = vec![DVec3::ZERO; places.len()];
        for (stencil, k) in family {
            let bent = deviation(&stencil, &places);
            for (at, share) in stencil {
                moved[at] -= weight * k * share / masses[at] * bent;
            }
        }
        moved
    })
}

/// What all families add, one after the other.
pub(super) fn expected(grid: &ClothGrid, particles: &ClothParticles, weight: f64) -> Vec<DVec3> {
    let (masses, start) = start(particles);
    let mut place = start.clone();
    let count = place.len();
    for family in families(grid) {
        let mut matrix = vec![vec![0.0; count]; count];
        let mut right = vec![DVec3::ZERO; count];
        for (stencil, k) in family {
            let bent = deviation(&stencil, &place);
            for &(a, of_a) in &stencil {
                if masses[a].is_finite() {
                    right[a] -= weight * k * of_a * bent;
                    for &(b, of_b) in &stencil {
                        if masses[b].is_finite() {
                            matrix[a][b] += weight * k * of_a * of_b;
                        }
                    }
                }
            }
        }
        for (at, mass) in masses.iter().enumerate() {
            matrix[at][at] += if mass.is_finite() { *mass } else { 1.0 };
        }
        solve_dense(&mut matrix, &mut right);
        for (place, moved) in place.iter_mut().zip(right) {
            *place += moved;
        }
    }
    place
        .iter()
        .zip(start)
        .map(|(end, start)| *end - start)
        .collect()
}
