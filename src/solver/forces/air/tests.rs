//! The faces of particles, the wind between its knots, and the bits of both.

use bevy::math::{DVec3, Vec3};

use super::*;
use crate::solver::kernels::air_areas;
use crate::{
    cloth::{Cloth, ClothMaterial, DX, Springs, X},
    meshes,
    solver::{
        forces::{ForceInputs, Forces},
        kernels::SimdLevel,
        step::TickStep,
        substep::Solver,
    },
};

const AIR: Air = Air {
    density: 1.2,
    drag: 1.2,
    lift: 1.5,
    wind: Vec3::new(2.0, -1.0, 6.0),
};

/// Its air alone.
fn in_air() -> ForceInputs {
    ForceInputs {
        air: Some(AIR),
        ..ForceInputs::default()
    }
}

/// A crumpled grid.
fn crumpled(columns: u32, rows: u32) -> (Surface, ClothParticles) {
    let grid = Cloth::new(columns, rows, 0.1)
        .grid(Vec3::ONE)
        .expect("a grid");
    let surface = Surface::of_grid(&grid);
    let material = ClothMaterial::COTTON;
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a material");
    shake(&mut particles);
    (surface, particles)
}

/// Moves each particle by up to 2 cm along each axis.
fn shake(particles: &mut ClothParticles) {
    for index in 0..particles.len() {
        let phase = index as f32;
        let shake = Vec3::new(phase.sin(), (1.7 * phase).cos(), (0.3 * phase).sin());
        let place = particles.position_at(index) + 0.02 * shake;
        particles.set_position(index, place).expect("it exists");
    }
}

/// As brute force finds it, of each number of columns that fills its lanes in another way; to the rounding of three products.
#[test]
fn a_particle_stands_for_half_the_diamond_of_its_neighbours() {
    for (columns, rows) in [(2, 2), (7, 3), (8, 4), (9, 5), (16, 3), (33, 6), (64, 2)] {
        let (surface, particles) = crumpled(columns, rows);
        let mut airflow = Airflow::new(&surface);
        let layout = particles.layout();
        let strip = layout.strip as usize;
        for row in 0..rows as usize {
            let of = |row: usize| &particles.blocks()[row * strip..(row + 1) * strip];
            let around = Rows {
                own: of(row),
                above: of(row.saturating_sub(1)),
                below: of((row + 1).min(rows as usize - 1)),
                last: layout.slot(0, columns - 1),
            };
            air_areas(&around, &mut airflow.areas);
            for column in 0..columns as usize {
                let at = |row: usize, column: usize| {
                    let row = row.min(rows as usize - 1);
                    let column = column.min(columns as usize - 1);
                    particles.position_at(row * columns as usize + column)
                };
                let down = at(row + 1, column) - at(row.saturating_sub(1), column);
                let across = at(row, column + 1) - at(row, column.saturating_sub(1));
                let expected = down.cross(across) / 4.0;
                let slot = layout.slot(0, column as u32);
                let found = airflow.areas[slot.block].map(|lanes| lanes[slot.lane]);
                assert!(
                    expected.distance(found.into()) < 1.0e-8,
                    "{columns} × {rows}: {expected} {found:?} in {row}, {column}"
                );
            }
        }
    }
}

/// As brute force finds it in f64, of a crumpled mesh that need not be closed: its volume is that of the pyramids on its faces, with
/// the tip in its first particle. Two sides of 0.2 m, each off by two roundings of 1 m, make 2.4·10⁻⁸ m² a face. A particle has a
/// third of eight faces: 6.4·10⁻⁸ m². A third of 80 of them, times 1.2 m, makes 2·10⁻⁶ m³.
#[test]
fn a_particle_of_a_mesh_stands_for_a_third_of_its_triangles() {
    let mesh = meshes::irregular(0.9, 0.7, 0.1, 0.3);
    let surface = Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a surface");
    let mut particles =
        ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("a material");
    shake(&mut particles);
    let blocks = particles.blocks();
    let mut areas = vec![[[0.0; LANES]; 3]; blocks.len()];
    let enclosed = Triangles::new(&surface).areas(blocks, surface.layout(), &mut areas);
    let places: Vec<DVec3> = particles.positions().map(Vec3::as_dvec3).collect();
    let mut expected = vec![DVec3::ZERO; places.len()];
    let mut volume = 0.0;
    for corners in surface.triangles() {
        let [a, b, c] = corners.map(|corner| places[corner as usize] - places[0]);
        let area = (b - a).cross(c - a) / 2.0;
        volume += a.dot(area) / 3.0;
        for corner in corners {
            expected[*corner as usize] += area / 3.0;
        }
    }
    for (slot, expected) in surface.layout().slots().zip(&expected) {
        let found = areas[slot.block].map(|lanes| f64::from(lanes[slot.lane]));
        let off = expected.distance(found.into());
        assert!(off < 6.4e-8, "{expected} {found:?}");
    }
    let area: f64 = expected.iter().map(|area| area.length()).sum();
    let volume = enclosed.outwards * volume;
    assert!((enclosed.volume - volume).abs() < 2.0e-6 && volume.abs() > 1.0e-4);
    assert!((enclosed.area - area).abs() < 80.0 * 6.4e-8);
}

/// A wind that grows evenly along a flat grid, and through a mesh, is met to the last digits; each knot is where it is asked for.
#[test]
fn a_wind_that_grows_evenly_is_interpolated_exactly() {
    for (columns, rows) in [(2, 2), (9, 3), (33, 40), (64, 64)] {
        let grid = Cloth::new(columns, rows, 0.1)
            .grid(Vec3::ONE)
            .expect("a grid");
        let flat = Surface::of_grid(&grid);
        let material = ClothMaterial::COTTON;
        let particles = ClothParticles::at_rest(&flat, &material).expect("a material");
        let wind = |place: Vec3| Vec3::new(1.0 + place.x, 2.0 * place.y, place.x - 3.0 * place.y);
        let layout = particles.layout();
        let strip = layout.strip as usize;
        let mut local = LocalWind::default();
        local.sample(&particles, true, wind);
        let mut winds = vec![[[0.0; LANES]; 3]; strip];
        for row in 0..rows {
            local.of_row(row as usize, layout, &mut winds);
            for column in 0..columns {
                let slot = layout.slot(0, column);
                let found = Vec3::from(winds[slot.block].map(|lanes| lanes[slot.lane]));
                let place = particles.position((row, column)).expect("it exists");
                assert!(
                    found.distance(wind(place)) < 1.0e-4,
                    "{columns} × {rows}: {found}"
                );
            }
        }
        local.sample(&particles, false, wind);
        let mut winds = vec![[[0.0; LANES]; 3]; layout.blocks()];
        local.of_mesh(&particles, &mut winds);
        for (place, slot) in particles.positions().zip(layout.slots()) {
            let found = Vec3::from(winds[slot.block].map(|lanes| lanes[slot.lane]));
            assert!(
                found.distance(wind(place)) < 1.0e-4,
                "{columns} × {rows}: {found}"
            );
        }
    }
}

/// Soft cloth, whose springs push by their forces, and stiff cloth; what the air gave included.
#[test]
fn every_instruction_set_and_thread_count_gives_the_same_bits() {
    for compliance in [0.0, 1.0e-2] {
        let material = ClothMaterial {
            stretch_compliance: compliance,
            shear_compliance: compliance,
            ..ClothMaterial::COTTON
        };
        let (surface, start) = crumpled(33, 80);
        let springs = Springs::of_surface(&surface, &material);
        let run = |level: SimdLevel, partitions: usize| {
            let mut solver = Solver::of_surface(&surface, &springs);
            solver.set_simd_level(level);
            solver.set_partitions(partitions);
            solver.forces.set(&surface, in_air());
            let mut particles = start.clone();
            for _ in 0..6 {
                solver
                    .forces
                    .set_local_wind(&particles, |place| AIR.wind + place);
                solver.advance(&mut particles, TickStep::default(), &[], |_, _| false);
            }
            let impulse = solver.forces.impulse().to_array().map(f32::to_bits);
            (particles, impulse)
        };
        let truth = run(SimdLevel::Baseline, 1);
        for (level, partitions) in [
            (SimdLevel::Auto, 1),
            (SimdLevel::Auto, 2),
            (SimdLevel::Baseline, 2),
        ] {
            assert!(
                run(level, partitions) == truth,
                "{compliance} m/N, {level:?}, {partitions} partitions"
            );
        }
    }
}

/// Particles are up to 10¹⁸ m apart, the limit of valid ones, and move by up to that in a sub-step. Some are as light or as heavy as
/// they may be. The gas in a grid has no volume. Near places and slow particles are pushed.
#[test]
fn the_air_of_any_place_and_speed_is_finite() {
    let mesh = meshes::irregular(0.9, 0.7, 0.1, 0.3);
    let mesh = Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a surface");
    let of_mesh = ClothParticles::at_rest(&mesh, &ClothMaterial::COTTON).expect("a material");
    for (surface, particles) in [crumpled(9, 7), (mesh, of_mesh)] {
        let each = (0..18 * 18).flat_map(|at| [1.0e-45, 2.0e-39, 1.0e-29, 1.0e15].map(|w| (at, w)));
        let pressures = [
            None,
            Some(ClothPressure::Gauge(500.0)),
            Some(ClothPressure::Gas {
                volume: 1.0,
                outside: 1.0e5,
            }),
        ];
        for ((at, inverse_mass), pressure) in each.flat_map(|one| pressures.map(|of| (one, of))) {
            let inputs = ForceInputs {
                pressure,
                ..in_air()
            };
            let (far, fast) = (at / 18, at % 18);
            let mut particles = particles.clone();
            shake(&mut particles);
            for index in 0..particles.len() {
                let place = particles.position_at(index) * 10.0_f32.powi(far);
                let moved = Vec3::splat(0.5 * 10.0_f32.powi(fast)) * (index as f32).cos();
                particles.set_position(index, place).expect("it exists");
                particles.set_displacement(index, moved).expect("it exists");
                if index % 3 == 0 {
                    particles
                        .set_inverse_mass(index, inverse_mass)
                        .expect("it exists");
                }
            }
            let (kernels, mut forces) = (SimdLevel::Auto.kernels(), Forces::default());
            forces.set(&surface, inputs);
            forces.begin(1.0 / 64.0, 4);
            forces.before_substep(0, &particles, &kernels);
            for index in 0..particles.len() {
                let slot = surface.layout().slot_of(index);
                let view = particles.blocks_mut()[slot.block].view_mut();
                for axis in [0, LANES, 2 * LANES] {
                    view[X + axis + slot.lane] += view[DX + axis + slot.lane];
                }
            }
            forces.press(particles.blocks_mut(), 1.0e-5);
            forces.settle(&particles, &kernels);
            let is_finite = |l: &LinearForce| {
                let both = l.push.iter().chain(&l.drag).flatten();
                both.clone().all(|value| value.is_finite())
            };
            let impulse = forces.impulse();
            let linearized = forces.linearized().expect("air");
            assert!(
                linearized.iter().all(is_finite) && impulse.is_finite(),
                "10^{far} m, 10^{fast} m a sub-step, {inverse_mass} per kg: {impulse}"
            );
            let is_pushed = |l: &LinearForce| l.push.iter().flatten().any(|push| *push != 0.0);
            let is_ordinary = far == 0 && fast == 0;
            assert!(!is_ordinary || linearized.iter().any(is_pushed));
        }
    }
}
