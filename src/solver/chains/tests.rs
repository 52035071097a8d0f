//! Chains solved side by side against one after the other in f64.

use std::collections::HashMap;

use bevy::math::{DVec3, Vec3};

use super::grid::GridSolver;
use crate::{
    cloth::{
        Cloth, ClothGrid, ClothMaterial, ClothParticles, Compliances, Spring, SpringKind,
        SpringList, Surface,
    },
    solver::{
        kernels::{Direction, SimdLevel, StepScale},
        spring_solver::{Motion, SpringSolver},
        tether::{Anchors, Tethers},
    },
};

const WEIGHT_DT2: f32 = 1.0 / 1200.0 / 1200.0;

/// `SplitMix64`, from −1 to 1.
pub(crate) fn random(seed: &mut u64) -> f32 {
    *seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (*seed ^ (*seed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
}

/// A crumpled cloth with a few pins anywhere, and a few heavy particles.
fn crumpled(columns: u32, rows: u32, noise: f32) -> (ClothGrid, ClothParticles) {
    let grid = Cloth::new(columns, rows, 0.1)
        .grid(Vec3::new(1.0, 1.3, 1.0))
        .expect("a valid grid");
    let mut particles = ClothParticles::at_rest(&Surface::of_grid(&grid), &ClothMaterial::COTTON)
        .expect("a valid material");
    let mut seed = u64::from(columns * 1000 + rows);
    for (row, column) in grid.cells() {
        let off = Vec3::from([(); 3].map(|()| noise * random(&mut seed)));
        let moved = Vec3::from([(); 3].map(|()| 0.1 * noise * random(&mut seed)));
        let position = grid.rest_position(row, column) + off;
        let inverse_mass = match random(&mut seed) {
            0.9.. => 0.0,
            0.8..0.9 => 10.0,
            _ => 600.0,
        };
        particles
            .set_position((row, column), position)
            .and_then(|()| particles.set_displacement((row, column), moved))
            .and_then(|()| particles.set_inverse_mass((row, column), inverse_mass))
            .expect("it exists");
    }
    (grid, particles)
}

/// The chains of one direction, as particles.
fn chains(grid: &ClothGrid, (down, across): (u32, i32)) -> Vec<Vec<(u32, u32)>> {
    let next = |(row, column): (u32, u32)| {
        let (row, column) = (row + down, column.checked_add_signed(across)?);
        (row < grid.rows() && column < grid.columns()).then_some((row, column))
    };
    let is_first = |&(row, column): &(u32, u32)| {
        let before = row
            .checked_sub(down)
            .zip(column.checked_add_signed(-across));
        before.is_none_or(|(_, column)| column >= grid.columns())
    };
    let chain = |first| std::iter::successors(Some(first), |&cell| next(cell)).collect();
    grid.cells().filter(is_first).map(chain).collect()
}

/// Solves a system by elimination with pivots.
pub(crate) fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for at in 0..n {
        let best = (at..n)
            .max_by(|&a, &b| matrix[a][at].abs().total_cmp(&matrix[b][at].abs()))
            .expect("a row");
        matrix.swap(at, best);
        right.swap(at, best);
        for below in at + 1..n {
            let factor = matrix[below][at] / matrix[at][at];
            let (upper, lower) = matrix.split_at_mut(below);
            for (own, other) in lower[0].iter_mut().zip(&upper[at]).skip(at) {
                *own -= factor * other;
            }
            right[below] -= factor * right[at];
        }
    }
    for at in (0..n).rev() {
        let known: f64 = (at + 1..n)
            .map(|column| matrix[at][column] * right[column])
            .sum();
        right[at] = (right[at] - known) / matrix[at][at];
    }
    right
}

/// Moves displacements as one chain's springs do, in f64, by the equations of [`super`].
fn solve_chain(
    chain: &[(u32, u32)],
    particles: &ClothParticles,
    rest: f64,
    compliance: impl Fn((u32, u32)) -> f64,
    moved: &mut [DVec3],
) {
    let at = |cell: (u32, u32)| particles.index(cell).expect("it exists");
    let place = |cell| particles.position_at(at(cell)).as_dvec3() + moved[at(cell)];
    let weight = |cell| f64::from(particles.inverse_mass(cell).expect("it exists"));
    let springs: Vec<_> = chain.windows(2).map(|ends| (ends[0], ends[1])).collect();
    let spans: Vec<DVec3> = springs
        .iter()
        .map(|(a, b)| (place(*b) - place(*a)) / rest)
        .collect();
    let n = springs.len();
    if n == 0 {
        return;
    }
    let mut matrix = vec![vec![0.0; n]; n];
    let mut right = vec![0.0; n];
    for (i, (a, b)) in springs.iter().enumerate() {
        let p = spans[i].length_squared();
        let sum = weight(*a) + weight(*b);
        let soft = compliance(*a) / f64::from(WEIGHT_DT2) * p;
        matrix[i][i] = sum * p + soft.max((1.0e-3 + 0.2 * (p - 1.0).abs()) * sum) + 1.0e-18;
        if i + 1 < n {
            let off = -weight(*b) * spans[i].dot(spans[i + 1]);
            (matrix[i][i + 1], matrix[i + 1][i]) = (off, off);
        }
        right[i] = -rest * p * (p - 1.0) / (1.5 * p + 0.5);
    }
    let multipliers = solved(matrix, right);
    for (i, (a, b)) in springs.iter().enumerate() {
        moved[at(*a)] -= weight(*a) * multipliers[i] * spans[i];
        moved[at(*b)] += weight(*b) * multipliers[i] * spans[i];
    }
}

/// Solves all chains of one direction.
fn solve_family(of: &mut GridSolver, step: (u32, i32), particles: &mut ClothParticles) {
    of.set_step_scale(StepScale::new(WEIGHT_DT2, 1.0, 0.0));
    let kernels = SimdLevel::Auto.kernels();
    let blocks = particles.blocks_mut();
    match step {
        (0, 1) => of.solve_across(blocks, &kernels),
        (1, 0) => of.solve_down(blocks, Direction::Down, &kernels),
        (1, 1) => of.solve_down(blocks, Direction::Right, &kernels),
        _ => of.solve_down(blocks, Direction::Left, &kernels),
    }
}

/// In grids that fill their lanes and that do not, with pins in chains, crumpled a little and a lot, rigid and soft.
#[test]
fn each_family_is_solved_as_by_elimination_in_f64() {
    for (columns, rows) in [
        (2, 2),
        (3, 5),
        (7, 9),
        (8, 8),
        (9, 17),
        (16, 16),
        (17, 3),
        (33, 20),
        (70, 11),
    ] {
        for (noise, compliance) in [(0.01, 0.0), (0.01, 1.0e-3), (0.05, 1.0e-4), (0.05, 0.0)] {
            let (grid, start) = crumpled(columns, rows, noise);
            let compliances = Compliances {
                structural: [5.0 * compliance, compliance],
                shear: 2.0 * compliance,
            };
            for step in [(0, 1), (1, 0), (1, 1), (1, -1)] {
                let mut spring_solver = GridSolver::new(&grid, &compliances);
                let mut particles = start.clone();
                solve_family(&mut spring_solver, step, &mut particles);
                let mut moved: Vec<DVec3> = start.displacements().map(Vec3::as_dvec3).collect();
                for chain in chains(&grid, step) {
                    let soft = |cell| {
                        let cell = if step == (1, -1) { (0, 0) } else { cell };
                        let kind = if step == (1, -1) { (1, 1) } else { step };
                        compliances
                            .of_strip(&grid, kind, cell)
                            .map_or(0.0, f64::from)
                    };
                    let rest = f64::from(grid.step_length(step));
                    solve_chain(&chain, &start, rest, soft, &mut moved);
                }
                for (index, (found, expected)) in particles.displacements().zip(&moved).enumerate()
                {
                    let off = found.as_dvec3().distance(*expected);
                    // 1e-6 of lengths of 0.1 m that a system of condition 1/ε = 1e3 enlarges.
                    assert!(
                        off < 1.0e-4,
                        "{columns} × {rows}, {step:?}, {noise} {compliance}, {index}: {off:e}"
                    );
                }
            }
        }
    }
}

/// The springs of a grid in a list, each with as many times the compliance as `factor` says; `None` for those that are torn.
fn listed(
    grid: &ClothGrid,
    compliances: &Compliances,
    mut factor: impl FnMut() -> Option<f32>,
) -> SpringList {
    let mut list = SpringList::default();
    for step in [(0, 1), (1, 0), (1, 1), (1, -1)] {
        for (a, b) in chains(grid, step)
            .iter()
            .flat_map(|chain| chain.windows(2))
            .map(|of| (of[0], of[1]))
        {
            // Both diagonals are as wide.
            let (kind, at) = if step == (1, -1) {
                ((1, 1), (0, 0))
            } else {
                (step, a)
            };
            let compliance = compliances.of_strip(grid, kind, at);
            if let (Some(compliance), Some(factor)) = (compliance, factor()) {
                list.springs.push(Spring {
                    kind: SpringKind::Structural,
                    ends: [a, b].map(|(row, column)| grid.index(row, column)),
                    rest_length: grid.step_length(kind),
                    compliance: factor * compliance,
                });
            }
        }
    }
    list
}

/// The same of grids that are torn and mapped at random: a chain that is cut is two, and each spring has a stiffness of its own.
#[test]
fn torn_and_mapped_families_are_solved_as_by_elimination_in_f64() {
    for (columns, rows) in [
        (2, 2),
        (2, 5),
        (3, 5),
        (9, 17),
        (16, 16),
        (33, 20),
        (70, 11),
    ] {
        for (noise, compliance) in [(0.01, 0.0), (0.01, 1.0e-3), (0.05, 1.0e-4)] {
            let (grid, start) = crumpled(columns, rows, noise);
            let compliances = Compliances {
                structural: [5.0 * compliance, compliance],
                shear: 2.0 * compliance,
            };
            let mut seed = u64::from(columns);
            let list = listed(&grid, &compliances, || {
                let torn = random(&mut seed) > 0.7;
                (!torn).then_some(3.0_f32.powf(random(&mut seed)))
            });
            let springs: HashMap<[u32; 2], Spring> = list
                .springs
                .iter()
                .map(|spring| (spring.ends, *spring))
                .collect();
            let between = |a: (u32, u32), b: (u32, u32)| {
                springs.get(&[a, b].map(|(row, column)| grid.index(row, column)))
            };
            for step in [(0, 1), (1, 0), (1, 1), (1, -1)] {
                let mut spring_solver = GridSolver::of_list(&grid, &list);
                let mut particles = start.clone();
                solve_family(&mut spring_solver, step, &mut particles);
                let mut moved: Vec<DVec3> = start.displacements().map(Vec3::as_dvec3).collect();
                let rest = f64::from(grid.step_length(step));
                for chain in chains(&grid, step) {
                    for piece in chain.chunk_by(|a, b| between(*a, *b).is_some()) {
                        let next =
                            |cell| piece[1 + piece.iter().position(|at| *at == cell).unwrap_or(0)];
                        let soft =
                            |cell| between(cell, next(cell)).map_or(0.0, |of| of.compliance.into());
                        solve_chain(piece, &start, rest, soft, &mut moved);
                    }
                }
                for (index, (found, expected)) in particles.displacements().zip(&moved).enumerate()
                {
                    let off = found.as_dvec3().distance(*expected);
                    // As above.
                    assert!(
                        off < 1.0e-4,
                        "{columns} × {rows}, {step:?}, {noise} {compliance}, {index}: {off:e}"
                    );
                }
            }
        }
    }
}

/// All springs of a grid in a list are solved to the same bits as the grid's, in the second pass too, and measured alike. Their tension is
/// known one by one; a grid takes that of its borders, which are half as stiff, for twice as much. So its ω may be √2 times as much.
#[test]
fn a_grid_in_a_list_has_the_same_bits() {
    for (columns, rows) in [(9, 17), (16, 16), (33, 20), (70, 11)] {
        for compliance in [0.0, 1.0e-4] {
            let compliances = Compliances {
                structural: [compliance, 3.0 * compliance],
                shear: 2.0 * compliance,
            };
            let (grid, start) = crumpled(columns, rows, 0.02);
            let listed = listed(&grid, &compliances, || Some(1.0));
            let solvers = [
                GridSolver::new(&grid, &compliances),
                GridSolver::of_list(&grid, &listed),
            ];
            let [whole, listed] = solvers.map(|mut solver| {
                solver.set_step_scale(StepScale::new(WEIGHT_DT2, 1.0, 0.0));
                let kernels = SimdLevel::Auto.kernels();
                let motion = Motion {
                    kernels: &kernels,
                    tethers: &Tethers::default(),
                    anchors: &Anchors::default(),
                    begins: true,
                    measures: true,
                };
                let mut particles = start.clone();
                let solved = solver.substep(particles.blocks_mut(), &motion, 1);
                let places: Vec<Vec3> = particles.positions().collect();
                ((places, solved.stretch, solved.moved), solved.ripple)
            });
            assert!(whole.0 == listed.0, "{columns} × {rows}, {compliance}");
            let (whole, listed) = (whole.1, listed.1);
            let is_like = listed <= 1.01 * whole && listed >= 0.7 * whole;
            assert!(
                is_like,
                "{columns} × {rows}, {compliance}: {whole} {listed}"
            );
        }
    }
}

/// Solved again at once, elastic chains have nothing left but the curvature of their equations: a relative error of the
/// order of the noise in lengths, 1 %, which each solve leaves of what it finds. A spring whose first pull was forgotten
/// would pull as far once more. (Rigid chains have no such pull, and between two pins they have no solution.)
#[test]
fn what_is_solved_again_goes_on_from_its_pull() {
    for (columns, rows) in [(9, 17), (33, 20), (70, 11)] {
        for compliance in [1.0e-4, 1.0e-2] {
            for (down, is_torn) in [(false, false), (true, false), (false, true), (true, true)] {
                let (grid, mut particles) = crumpled(columns, rows, 0.001);
                let compliances = Compliances {
                    structural: [compliance; 2],
                    shear: compliance,
                };
                let mut seed = u64::from(rows);
                let torn = listed(&grid, &compliances, || {
                    (random(&mut seed) < 0.7).then_some(3.0_f32.powf(random(&mut seed)))
                });
                let mut spring_solver = match is_torn {
                    true => GridSolver::of_list(&grid, &torn),
                    false => GridSolver::new(&grid, &compliances),
                };
                spring_solver.set_step_scale(StepScale::new(WEIGHT_DT2, 1.0, 0.0));
                let kernels = SimdLevel::Auto.kernels();
                let displaced = |particles: &ClothParticles| -> Vec<Vec3> {
                    particles.displacements().collect()
                };
                let start = displaced(&particles);
                spring_solver.solve_across(particles.blocks_mut(), &kernels);
                if down {
                    spring_solver.solve_down(particles.blocks_mut(), Direction::Down, &kernels);
                }
                let once = displaced(&particles);
                let (second_pass, mut springs) = spring_solver.second_pass(1);
                second_pass.solve_all(particles.blocks_mut(), &mut springs, down);
                let twice = displaced(&particles);
                let farthest = |a: &[Vec3], b: &[Vec3]| {
                    let moves = a.iter().zip(b).map(|(a, b)| a.distance(*b));
                    moves.fold(0.0, f32::max)
                };
                let (first, second) = (farthest(&start, &once), farthest(&once, &twice));
                assert!(
                    second < 0.1 * first,
                    "{columns} × {rows}, {compliance}, {down}: {first} {second}"
                );
            }
        }
    }
}

/// A flat cloth that falls has nothing left, and nothing of it is solved twice; of a crumpled one something is.
#[test]
fn a_quiet_cloth_is_solved_once() {
    let (grid, noisy) = crumpled(40, 30, 0.01);
    let (_, mut quiet) = crumpled(40, 30, 0.0);
    for (row, column) in grid.cells() {
        let falls = Vec3::new(0.0, -0.001, 0.0);
        let cell = (row, column);
        (quiet.set_inverse_mass(cell, 600.0))
            .and_then(|()| quiet.set_displacement(cell, falls))
            .expect("it exists");
    }
    for compliance in [0.0, 1.0e-4] {
        for (start, is_quiet) in [(&quiet, true), (&noisy, false)] {
            let compliances = Compliances {
                structural: [compliance; 2],
                shear: f32::INFINITY,
            };
            let mut spring_solver = GridSolver::new(&grid, &compliances);
            spring_solver.set_step_scale(StepScale::new(WEIGHT_DT2, 1.0, 0.0));
            let kernels = SimdLevel::Auto.kernels();
            let motion = Motion {
                kernels: &kernels,
                tethers: &Tethers::default(),
                anchors: &Anchors::default(),
                begins: true,
                measures: true,
            };
            let (mut once, mut all) = (start.clone(), start.clone());
            spring_solver.solve_across(once.blocks_mut(), &kernels);
            spring_solver.solve_down(once.blocks_mut(), Direction::Down, &kernels);
            spring_solver.substep(all.blocks_mut(), &motion, 1);
            let moves = once.displacements().zip(all.displacements());
            let farthest = moves.map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
            assert_eq!(farthest < 1.0e-12, is_quiet, "{compliance}: {farthest}");
        }
    }
}
