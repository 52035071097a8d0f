//! Chains of a mesh side by side against one after the other in f64, and what no system has a solution for.

use bevy::math::{DVec3, Vec3, Vec4};

use super::Bundles;
use crate::{
    cloth::{ClothMaterial, ClothParticles, SpringList, SpringStorage, Springs, Surface},
    meshes,
    solver::{
        chains::tests::{random, solved},
        kernels::{Row, SimdLevel, StepScale, Stiffer},
        step::TickStep,
        substep::Solver,
    },
};

const INVERSE_WEIGHT: f32 = 1200.0 * 1200.0;

const PACE: StepScale = StepScale {
    inverse_weight: INVERSE_WEIGHT,
    kept: 1.0,
    stiffer: Stiffer::NONE,
};

fn surface() -> Surface {
    let mesh = meshes::irregular(1.0, 0.7, 0.05, 0.3);
    Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a surface")
}

fn list(surface: &Surface, compliance: f32) -> Springs {
    let material = ClothMaterial {
        stretch_compliance: compliance,
        shear_compliance: compliance,
        ..ClothMaterial::COTTON
    };
    Springs::of_surface(surface, &material)
}

fn chains_of(springs: &Springs) -> &SpringList {
    match springs.storage() {
        SpringStorage::List(list) => list,
        SpringStorage::Grid(..) => panic!("no mesh"),
    }
}

/// A crumpled cloth with a few pins anywhere and a few heavy particles, and a row for what is no particle.
fn crumpled(surface: &Surface, noise: f32) -> Vec<Row> {
    let mut seed = 5;
    let mut row = |place: &Vec3| {
        let off = Vec3::from([(); 3].map(|()| noise * random(&mut seed)));
        let moved = Vec3::from([(); 3].map(|()| 0.1 * noise * random(&mut seed)));
        let inverse_mass = match random(&mut seed) {
            0.9.. => 0.0,
            0.8..0.9 => 10.0,
            _ => 600.0,
        };
        Row {
            place: (*place + off).extend(inverse_mass),
            moved: moved.extend(0.0),
        }
    };
    let mut rows: Vec<Row> = surface.rest_positions().iter().map(&mut row).collect();
    rows.push(Row::default());
    rows
}

/// Moves displacements as one chain's springs do, in f64, by the equations of [`super`], after they have pulled with `pulled`.
fn solve_chain(
    (first, edges): (u32, &[u32]),
    list: &SpringList,
    rows: &[Row],
    moved: &mut [DVec3],
    pulled: &mut [f64],
) {
    let place = |at: u32, moved: &[DVec3]| {
        rows[at as usize].place.truncate().as_dvec3() + moved[at as usize]
    };
    let weight = |at: u32| f64::from(rows[at as usize].place.w);
    let n = edges.len();
    let mut particles = vec![first];
    for edge in edges {
        let [a, b] = list.springs[*edge as usize].ends;
        let at = particles[particles.len() - 1];
        particles.push(if at == a { b } else { a });
    }
    let (mut matrix, mut right) = (vec![vec![0.0; n]; n], vec![0.0; n]);
    let spring = |i: usize| &list.springs[edges[i] as usize];
    let span = |i: usize| {
        let [a, b] = [particles[i], particles[i + 1]].map(|at| place(at, moved));
        (b - a) / f64::from(spring(i).rest_length)
    };
    let spans: Vec<DVec3> = (0..n).map(span).collect();
    for i in 0..n {
        let p = spans[i].length_squared();
        let sum = weight(particles[i]) + weight(particles[i + 1]);
        let soft = f64::from(spring(i).compliance) * f64::from(INVERSE_WEIGHT) * p;
        matrix[i][i] = sum * p + soft.max((1.0e-3 + 0.2 * (p - 1.0).abs()) * sum) + 1.0e-18;
        if i + 1 < n {
            let off = -weight(particles[i + 1]) * spans[i].dot(spans[i + 1]);
            (matrix[i][i + 1], matrix[i + 1][i]) = (off, off);
        }
        let rest = f64::from(spring(i).rest_length);
        right[i] = -rest * p * (p - 1.0) / (1.5 * p + 0.5) - soft * pulled[edges[i] as usize];
    }
    for (i, multiplier) in solved(matrix, right).into_iter().enumerate() {
        let [a, b] = [particles[i], particles[i + 1]];
        moved[a as usize] -= weight(a) * multiplier * spans[i];
        moved[b as usize] += weight(b) * multiplier * spans[i];
        pulled[edges[i] as usize] += multiplier;
    }
}

/// There and back, crumpled a little and a lot, rigid and soft, by both instruction sets.
#[test]
fn chains_are_solved_as_by_elimination_in_f64() {
    let surface = surface();
    for (noise, compliance) in [(0.001, 0.0), (0.005, 1.0e-3), (0.02, 1.0e-4), (0.01, 0.0)] {
        let springs = list(&surface, compliance);
        let list = chains_of(&springs);
        let start = crumpled(&surface, noise);
        let mut moved: Vec<DVec3> = start
            .iter()
            .map(|row| row.moved.truncate().as_dvec3())
            .collect();
        let mut pulled = vec![0.0; list.springs.len()];
        let chains = list.chains.iter();
        let all: Vec<(u32, &[u32])> = chains
            .map(|chain| (chain.first, chain.edges.as_slice()))
            .collect();
        for chain in all.iter().chain(all.iter().rev()) {
            solve_chain(*chain, list, &start, &mut moved, &mut pulled);
        }
        let results = [SimdLevel::Auto, SimdLevel::Baseline].map(|level| {
            let kernels = level.kernels();
            let mut rows = start.clone();
            let mut bundles = Bundles::new(list, |particle| particle, surface.len() as u32);
            // Twice: nothing stays from one sub-step to the next.
            for _ in 0..2 {
                rows.clone_from(&start);
                bundles.solve_there(&mut rows, &PACE, &kernels);
                bundles.solve_back(&mut rows, &PACE, &kernels);
            }
            rows
        });
        for (index, (found, expected)) in results[0].iter().zip(&moved).enumerate() {
            let off = found.moved.truncate().as_dvec3().distance(*expected);
            // 1e-7 of 1 m that systems of condition 1/ε = 1e3 enlarge.
            assert!(off < 1.0e-4, "{noise} {compliance}, {index}: {off:e}");
            assert!(found.moved.w == 0.0 && found.place == start[index].place);
        }
        let moved = results.map(|rows| rows.iter().map(|row| row.moved).collect::<Vec<Vec4>>());
        assert_eq!(moved[0], moved[1]);
    }
}

/// Each spring on a chain is in one lane, and few lanes have none: of meshes with short chains, too.
#[test]
fn lanes_are_full() {
    for (spacing, jitter) in [(0.05, 0.0), (0.05, 0.3), (0.02, 0.15), (0.02, 0.3)] {
        let mesh = meshes::irregular(1.0, 0.7, spacing, jitter);
        let surface = Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a surface");
        let springs = list(&surface, 1.0e-4);
        let list = chains_of(&springs);
        let bundles = Bundles::new(list, |particle| particle, surface.len() as u32);
        let mut found = Vec::new();
        bundles.for_each_pull(|[a, b], _, _, _| found.push([a.min(b), a.max(b)]));
        let edges = list.chains.iter().flat_map(|chain| &chain.edges);
        let ends = edges.map(|edge| list.springs[*edge as usize].ends);
        let mut expected: Vec<[u32; 2]> = ends.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected);
        let full = found.len() as f32 / (8 * bundles.steps.len()) as f32;
        println!(
            "{surface}, moved by {jitter} spacings: lanes are full by {:.0} %",
            100.0 * full
        );
        assert!(full > 0.7, "{full}");
    }
}

/// Straight between pins, all pinned, all in one point, in the origin, where rows without a particle are, too.
#[test]
fn chains_without_a_solution_are_no_nan() {
    let surface = surface();
    let springs = list(&surface, 0.0);
    let list = chains_of(&springs);
    let kernels = SimdLevel::Auto.kernels();
    type Case = fn(usize, Vec3) -> Vec4;
    let cases: [Case; 6] = [
        |index, place| place.extend(if index.is_multiple_of(2) { 0.0 } else { 500.0 }),
        |_, place| place.extend(0.0),
        |_, place| (place * 1.01).extend(0.0),
        |index, place| (place * 1.0e15).extend(if index < 40 { 0.0 } else { 500.0 }),
        |_, _| Vec4::new(0.3, 0.2, 0.1, 500.0),
        |_, _| Vec4::new(0.0, 0.0, 0.0, 500.0),
    ];
    for (index, case) in cases.into_iter().enumerate() {
        let places = surface.rest_positions().iter().enumerate();
        let mut rows: Vec<Row> = places
            .map(|(at, place)| Row {
                place: case(at, *place),
                moved: Vec4::ZERO,
            })
            .collect();
        rows.push(Row::default());
        let mut bundles = Bundles::new(list, |particle| particle, surface.len() as u32);
        for _ in 0..3 {
            bundles.solve_there(&mut rows, &PACE, &kernels);
            bundles.solve_back(&mut rows, &PACE, &kernels);
        }
        assert!(rows.iter().all(|row| row.moved.is_finite()), "{index}");
    }
}

/// Whole ticks with pins, tethers and damping, of second order.
#[test]
fn a_mesh_has_the_same_bits_on_every_instruction_set() {
    let surface = surface();
    let springs = list(&surface, 1.0e-4);
    let material = ClothMaterial::COTTON;
    let run = |level: SimdLevel| {
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a material");
        particles.set_inverse_mass(3, 0.0).expect("a particle");
        let mut solver = Solver::of_surface(&surface, &springs);
        solver.set_simd_level(level);
        let step = TickStep {
            substeps: 7,
            acceleration: Vec3::new(0.5, -9.81, 2.0),
            damping: 0.01,
            ..TickStep::default()
        };
        for _ in 0..30 {
            solver.advance(&mut particles, step, &[], |_, _| false);
        }
        particles
    };
    let particles = run(SimdLevel::Auto);
    assert!(particles == run(SimdLevel::Baseline));
    assert!(particles.positions().all(Vec3::is_finite));
}
