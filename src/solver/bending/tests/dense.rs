//! What dense matrices in f64 make of a grid's threads.

use bevy::math::DVec3;

use super::RIGIDITY;
use crate::cloth::{ClothGrid, ClothParticles};

/// Solves a dense symmetric system in place of its right side.
fn solve_dense(matrix: &mut [Vec<f64>], right: &mut [DVec3]) {
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

/// Threads in the order in which they are solved: of each, the k of three particles in a row (N/m).
pub(super) fn threads(grid: &ClothGrid) -> [Vec<([usize; 3], f64)>; 4] {
    let (rows, columns) = (grid.rows() as i64, grid.columns() as i64);
    let (wide, high) = (f64::from(grid.spacing().x), f64::from(grid.spacing().y));
    let rigidity = f64::from(RIGIDITY);
    let index = |row: i64, column: i64| (row * columns + column) as usize;
    [(1, 1), (-1, 1), (1, 0), (0, 1)].map(|(down, right): (i64, i64)| {
        let mut threads = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                let ends = [-1, 1].map(|way| (row + way * down, column + way * right));
                let exists = |(row, column): (i64, i64)| {
                    (0..rows).contains(&row) && (0..columns).contains(&column)
                };
                if !ends.into_iter().all(exists) {
                    continue;
                }
                let square = wide * wide + high * high;
                let oblique = rigidity * square * square / (6.0 * wide * wide * high * high);
                let k = match (down, right) {
                    (0, _) if row == 0 || row + 1 == rows => rigidity * high / 2.0 / wide.powi(3),
                    (0, _) => {
                        (rigidity - 2.0 * oblique * (wide * wide / square).powi(2)) * high
                            / wide.powi(3)
                    }
                    (_, 0) if column == 0 || column + 1 == columns => {
                        rigidity * wide / 2.0 / high.powi(3)
                    }
                    (_, 0) => {
                        (rigidity - 2.0 * oblique * (high * high / square).powi(2)) * wide
                            / high.powi(3)
                    }
                    _ => oblique * wide * high / (square * square),
                };
                let [before, after] = ends.map(|(row, column)| index(row, column));
                threads.push(([before, index(row, column), after], k));
            }
        }
        threads
    })
}

/// Masses (kg), and where particles will be.
fn start(particles: &ClothParticles) -> (Vec<f64>, Vec<DVec3>) {
    let masses = particles
        .inverse_masses()
        .map(|of| 1.0 / f64::from(of))
        .collect();
    let places = particles.positions().zip(particles.displacements());
    let places = places.map(|(place, moved)| place.as_dvec3() + moved.as_dvec3());
    (masses, places.collect())
}

/// How far the forces of each family of threads move particles.
pub(super) fn pushes(grid: &ClothGrid, particles: &ClothParticles, weight: f64) -> [Vec<DVec3>; 4] {
    let (masses, places) = start(particles);
    threads(grid).map(|threads| {
        let mut moved = vec![DVec3::ZERO; places.len()];
        for (ends, k) in threads {
            let bent = places[ends[0]] - 2.0 * places[ends[1]] + places[ends[2]];
            for (&end, share) in ends.iter().zip([1.0, -2.0, 1.0]) {
                moved[end] -= weight * k * share / masses[end] * bent;
            }
        }
        moved
    })
}

/// What all families of threads add, one after the other.
pub(super) fn expected(grid: &ClothGrid, particles: &ClothParticles, weight: f64) -> Vec<DVec3> {
    let (masses, start) = start(particles);
    let mut place = start.clone();
    let count = place.len();
    for threads in threads(grid) {
        let mut matrix = vec![vec![0.0; count]; count];
        let mut right = vec![DVec3::ZERO; count];
        for (ends, k) in threads {
            let bent = place[ends[0]] - 2.0 * place[ends[1]] + place[ends[2]];
            for (&a, of_a) in ends.iter().zip([1.0, -2.0, 1.0]) {
                if masses[a].is_finite() {
                    right[a] -= weight * k * of_a * bent;
                    for (&b, of_b) in ends.iter().zip([1.0, -2.0, 1.0]) {
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
