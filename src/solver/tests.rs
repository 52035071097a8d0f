//! The vectorised sweep against one spring after the other in f64; threads and instruction sets against each other.

use bevy::math::{DVec3, Vec3};

use super::{
    bending::Bending,
    kernels::{MIN_MOVE, SimdLevel},
    step::{DampingFrame, PinMotion, TickStep, TimeOrder},
    stretch::Stretch,
    substep::Solver,
    tether::Tethers,
};
use crate::cloth::{Cloth, ClothGrid, ClothMaterial, ClothParticles, Spring, Springs, Surface};

const STEP: TickStep = TickStep {
    seconds: 1.0 / 64.0,
    substeps: 20,
    acceleration: Vec3::new(0.3, -9.81, 0.2),
    damping: 0.01,
    damped_against: DampingFrame::Still,
    order: TimeOrder::Second,
    material_stretch: 0.0,
    has_layers: false,
};

/// `SplitMix64`, from −1 to 1.
fn random(seed: &mut u64) -> f32 {
    *seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (*seed ^ (*seed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
}

/// A cloth that is crumpled and moves, with pins and a heavy particle.
fn crumpled(columns: u32, rows: u32, material: &ClothMaterial) -> (ClothGrid, ClothParticles) {
    let grid = Cloth::new(columns, rows, 0.1)
        .grid(Vec3::new(1.0, 1.3, 1.0))
        .expect("a valid grid");
    let mut particles =
        ClothParticles::at_rest(&Surface::of_grid(&grid), material).expect("a valid material");
    let mut seed = u64::from(columns * 1000 + rows);
    for (row, column) in grid.cells() {
        let noise = Vec3::from([(); 3].map(|()| 0.04 * random(&mut seed)));
        let position = grid.rest_position(row, column) + noise;
        let velocity = Vec3::from([(); 3].map(|()| random(&mut seed)));
        particles
            .set_position((row, column), position)
            .and_then(|()| particles.set_velocity((row, column), velocity))
            .expect("it exists");
    }
    for (cell, inverse_mass) in [((0, 0), 0.0), ((0, columns - 1), 0.0), ((1, 1), 3.0)] {
        particles
            .set_inverse_mass(cell, inverse_mass)
            .expect("it exists");
    }
    (grid, particles)
}

/// Plain XPBD in f64 with the exact root, one spring after the other.
struct Twin {
    position: Vec<DVec3>,
    displacement: Vec<DVec3>,
    inverse_mass: Vec<f64>,
    springs: Vec<Spring>,
}

impl Twin {
    fn new(particles: &ClothParticles, springs: &Springs) -> Self {
        Self {
            position: particles.positions().map(Vec3::as_dvec3).collect(),
            displacement: particles.displacements().map(Vec3::as_dvec3).collect(),
            inverse_mass: particles.inverse_masses().map(f64::from).collect(),
            springs: springs.to_vec(),
        }
    }

    fn substep(&mut self, step: TickStep) {
        let dt = f64::from(step.seconds) / f64::from(step.substeps);
        let kept = (1.0 - f64::from(step.damping)).powf(dt * 60.0);
        for index in 0..self.position.len() {
            if self.inverse_mass[index] > 0.0 {
                let moved =
                    self.displacement[index] * kept + step.acceleration.as_dvec3() * dt * dt;
                self.displacement[index] = moved;
                self.position[index] += moved;
            }
        }
        for spring in &self.springs {
            let [a, b] = spring.ends.map(|end| end as usize);
            let span = self.position[b] - self.position[a];
            let (w_a, w_b) = (self.inverse_mass[a], self.inverse_mass[b]);
            let weight = w_a + w_b + f64::from(spring.compliance) / (dt * dt);
            if weight > 0.0 {
                let moved =
                    span.normalize() * ((span.length() - f64::from(spring.rest_length)) / weight);
                self.position[a] += moved * w_a;
                self.displacement[a] += moved * w_a;
                self.position[b] -= moved * w_b;
                self.displacement[b] -= moved * w_b;
            }
        }
    }
}

/// All materials' kinds of springs, on grids whose strips are multiples of four and not, with border masses,
/// pins and a heavy particle. A correction of a spring at stretch ε is off by ε²/4 of itself, that is ε³/4 of a
/// rest length. Here ε is 0.8 at first (noise of 4 cm at either end of 10 cm), so that a first look at the
/// start is exact to 0.8³/4 = 13 % of a spring at worst; the twin starts where a second of the solver's own has
/// left the cloth, at ε below 5 %, where it is 3·10⁻⁵ of a length of at most 26 cm, 12 springs to a particle: 10⁻⁴ m.
#[test]
fn a_sub_step_is_that_of_a_plain_solver_in_f64() {
    for (columns, rows) in [(5, 4), (16, 9), (32, 7), (33, 6), (48, 5), (70, 10)] {
        for shear_compliance in [0.0, 1.0e-3, f32::INFINITY] {
            let material = ClothMaterial {
                shear_compliance,
                ..ClothMaterial::COTTON
            };
            let (grid, mut particles) = crumpled(columns, rows, &material);
            let springs = Springs::of_grid(&grid, &material).to_vec();
            let springs = Springs::of_list(&springs, particles.len()).expect("valid springs");
            let mut solver = Solver::new(&springs, &particles);
            for _ in 0..64 {
                solver.advance(&mut particles, STEP, &[], |_, _| false);
            }
            let once = TickStep {
                seconds: STEP.seconds / 20.0,
                substeps: 1,
                ..STEP
            };
            let mut twin = Twin::new(&particles, &springs);
            solver.advance(&mut particles, once, &[], |_, _| false);
            twin.substep(once);
            for (index, position) in particles.positions().enumerate() {
                let off = position.as_dvec3().distance(twin.position[index]);
                assert!(off < 1.0e-4, "{columns} × {rows}, {index}: {off}");
            }
            // A wrong spring, or one left out, is off by ε × length: the test would see it.
            let stretch = Stretch::measure(&springs, &particles);
            assert!(stretch.structural > 2.0e-3, "{stretch:?}");
        }
    }
}

/// To the last bit, whatever does the work: partitions of rows on several threads, and the machine's widest
/// instructions against those that every machine has.
#[test]
fn threads_and_simd_levels_change_no_bit() {
    let mut most = 0;
    for (columns, rows) in [(64, 64), (40, 129), (33, 70), (72, 131), (49, 33)] {
        let material = ClothMaterial::COTTON;
        let (grid, start) = crumpled(columns, rows, &material);
        let springs = Springs::of_grid(&grid, &material);
        let pin = PinMotion {
            particle: 0,
            from: start.position(0).expect("it exists"),
            to: Vec3::splat(0.1),
        };
        let mut run = |simd_level: SimdLevel, partitions: usize| {
            let mut particles = start.clone();
            let mut solver = Solver::new(&springs, &particles);
            solver.set_tethers(Tethers::new(
                &Surface::of_grid(&grid),
                &material,
                &particles,
                9.81,
            ));
            solver.set_simd_level(simd_level);
            solver.set_partitions(partitions);
            most = most.max(solver.partitions());
            let mut stretch = Stretch::default();
            for _ in 0..20 {
                stretch = solver.advance(&mut particles, STEP, &[pin], |_, _| false);
            }
            (hash(&particles), stretch)
        };
        let truth = run(SimdLevel::Auto, 1);
        assert_eq!(run(SimdLevel::Baseline, 1), truth);
        for partitions in [2, 3, 4] {
            assert_eq!(
                run(SimdLevel::Auto, partitions),
                truth,
                "{partitions} partitions"
            );
            assert_eq!(
                run(SimdLevel::Baseline, partitions),
                truth,
                "{partitions} partitions"
            );
        }
    }
    assert_eq!(most, 4);
}

/// FNV-1a over all bits of positions and displacements.
fn hash(particles: &ClothParticles) -> u64 {
    let numbers = particles.positions().chain(particles.displacements());
    let bits = numbers.flat_map(|vector| vector.to_array().map(f32::to_bits));
    bits.fold(0xCBF2_9CE4_8422_2325, |hash, bits| {
        (hash ^ u64::from(bits)).wrapping_mul(0x100_0000_01B3)
    })
}

/// The stretch that the last sub-step measures on its way is that of each spring looked at one by one.
#[test]
fn the_stretch_measured_on_the_way_is_the_stretch() {
    for (columns, rows) in [(2, 2), (5, 4), (33, 6), (70, 11)] {
        for shear_compliance in [1.0e-3, f32::INFINITY] {
            let material = ClothMaterial {
                shear_compliance,
                ..ClothMaterial::COTTON
            };
            let (grid, mut particles) = crumpled(columns, rows, &material);
            let springs = Springs::of_grid(&grid, &material);
            let mut solver = Solver::new(&springs, &particles);
            for (ticks, moves) in [(1, false), (3, true), (3, false)] {
                let mut stretch = Stretch::default();
                for _ in 0..ticks {
                    stretch = solver.advance(&mut particles, STEP, &[], |particles, _| {
                        if moves {
                            let aside = Vec3::new(0.3, 0.2, 0.1);
                            particles.set_position(1, aside).expect("it exists");
                        }
                        moves
                    });
                }
                let truth = Stretch::measure(&springs, &particles);
                assert!((stretch.structural - truth.structural).abs() < 1.0e-5);
                assert!((stretch.bound - truth.bound).abs() < 1.0e-5);
                let measured = solver.measure(&particles);
                assert_eq!(
                    [measured.structural, measured.bound],
                    [stretch.structural, stretch.bound]
                );
            }
        }
    }
}

/// A grid's springs as a list, in another order of colours, come to the same state: hung until at rest, both are
/// where gravity and springs balance. They begin smooth, for what nothing bends back may stay folded in many ways. The list is solved by the twin's rule for a sub-step, too.
#[test]
fn a_list_of_springs_is_solved_like_a_grid() {
    let material = ClothMaterial {
        damping: 0.05,
        ..ClothMaterial::RUBBER
    };
    let (grid, mut start) = crumpled(9, 7, &material);
    for (row, column) in grid.cells() {
        let rest = grid.rest_position(row, column);
        start.set_position((row, column), rest).expect("it exists");
    }
    let springs = Springs::of_grid(&grid, &material);
    let positions: Vec<Vec3> = start.positions().collect();
    let inverse_masses: Vec<f32> = start.inverse_masses().collect();
    let mut listed = ClothParticles::new(&positions, &inverse_masses).expect("valid particles");
    let list = Springs::of_list(&springs.to_vec(), listed.len()).expect("valid springs");
    let mut solver = Solver::new(&list, &listed);
    let mut built = start;
    let mut on_grid = Solver::new(&springs, &built);
    let (mut stretch, mut truth) = (Stretch::default(), Stretch::default());
    let fine = TickStep {
        substeps: 80,
        ..STEP
    };
    for _ in 0..64 * 15 {
        stretch = solver.advance(&mut listed, fine, &[], |_, _| false);
        truth = on_grid.advance(&mut built, fine, &[], |_, _| false);
    }
    // What one sweep leaves of a spring's load, and with it the order's part in the result, is below
    // F (w + w) Δt², as for a hanging column: 63 particles' weight on one is 63 g Δt² = 0.4 mm a spring, and seven
    // hang from each other.
    for (a, b) in listed.positions().zip(built.positions()) {
        assert!(a.distance(b) < 7.0 * 4.0e-4, "{a} {b}");
    }
    assert!((stretch.structural - truth.structural).abs() < 4.0e-3);

    let mut twin = Twin::new(&listed, &list);
    let once = TickStep {
        seconds: STEP.seconds / 20.0,
        substeps: 1,
        ..STEP
    };
    solver.advance(&mut listed, once, &[], |_, _| false);
    twin.substep(once);
    for (position, truth) in listed.positions().zip(twin.position) {
        assert!(position.as_dvec3().distance(truth) < 1.0e-4);
    }
}

/// Tethers end each sub-step's sweep: none is longer than it may be, whether all pins are shared or each particle
/// has the nearest one's. To the rounding of a tether of 4 m, and to what Halley's step leaves of an excess ε:
/// ε³/4 of a length; a sub-step's is below 1 %.
#[test]
fn no_particle_is_beyond_its_tether() {
    for pins in [1_usize, 2, 4, 20, 32] {
        let material = ClothMaterial {
            stretch_compliance: 0.0,
            shear_compliance: 0.0,
            ..ClothMaterial::COTTON
        };
        let grid = Cloth::new(32, 24, 0.1)
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let mut particles =
            ClothParticles::at_rest(&Surface::of_grid(&grid), &material).expect("valid");
        for pin in 0..pins {
            particles
                .set_inverse_mass((0, (pin * 31 / pins.max(2)) as u32), 0.0)
                .expect("it exists");
        }
        let springs = Springs::of_grid(&grid, &material);
        let mut solver = Solver::new(&springs, &particles);
        let step = TickStep {
            substeps: 4,
            ..STEP
        };
        let tethers = Tethers::new(&Surface::of_grid(&grid), &material, &particles, 9.81);
        let largest = |solver: &mut Solver, particles: &mut ClothParticles| {
            (0..64).fold(0.0_f32, |largest, _| {
                solver.advance(particles, step, &[], |_, _| false);
                largest.max(tethers.largest_excess(particles))
            })
        };
        // One sweep leaves more to do than chains do.
        let list = Springs::of_list(&springs.to_vec(), particles.len()).expect("valid springs");
        let mut swept = Solver::new(&list, &particles);
        let without = largest(&mut swept, &mut particles.clone());
        solver.set_tethers(tethers.clone());
        // Pins farther apart than the cloth between them is long stay where they are put all the same.
        let mut torn = particles.clone();
        let far = Vec3::new(9.0, 1.0, 2.0);
        torn.set_position(0, far).expect("it exists");
        largest(&mut solver, &mut torn);
        for index in 0..32 {
            if torn.is_pinned(index) == Some(true) {
                let expected = if index == 0 {
                    Some(far)
                } else {
                    particles.position(index)
                };
                assert_eq!(torn.position(index), expected, "pin {index} of {pins}");
            }
        }
        let with = largest(&mut solver, &mut particles);
        // Where it is beyond two pins' tethers, the second correction may undo some of the first.
        let allowed = if pins > 4 || pins == 1 { 1.0e-5 } else { 0.03 };
        assert!(with < allowed, "{pins} pins: {with}");
        assert!(without > 5.0 * allowed, "{pins} pins: {without}");
    }
}

/// Between pins, between coincident particles and where pins are torn apart, nothing becomes infinite.
#[test]
fn what_cannot_be_satisfied_stays_finite() {
    let material = ClothMaterial {
        stretch_compliance: 0.0,
        shear_compliance: 0.0,
        bend_rigidity: 1.0,
        ..ClothMaterial::COTTON
    };
    let grid = Cloth::new(12, 12, 0.1)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    for place in [Vec3::ZERO, Vec3::splat(1.0e-20), Vec3::X * 1.0e15] {
        let mut particles =
            ClothParticles::at_rest(&Surface::of_grid(&grid), &material).expect("valid");
        for index in 0..particles.len() {
            let at = if index < 12 { place } else { Vec3::ZERO };
            particles.set_position(index, at).expect("it exists");
            if index < 24 {
                particles.set_inverse_mass(index, 0.0).expect("it exists");
            }
        }
        let springs = Springs::of_grid(&grid, &material);
        let mut solver = Solver::new(&springs, &particles);
        solver.set_bending(Bending::new(&Surface::of_grid(&grid), &material));
        solver.set_tethers(Tethers::new(
            &Surface::of_grid(&grid),
            &material,
            &particles,
            9.81,
        ));
        for _ in 0..10 {
            solver.advance(&mut particles, STEP, &[], |_, _| false);
            assert_eq!(particles.validate(), Ok(()), "{place}");
        }
    }
}

/// A flat cloth hangs by its top row and is poked in its middle: what its corners make of that is no motion, and no
/// subnormal number either.
#[test]
fn what_hardly_moves_does_not_move() {
    let material = ClothMaterial::COTTON;
    let grid = Cloth::new(64, 64, 0.03)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let springs = Springs::of_grid(&grid, &material);
    let mut particles =
        ClothParticles::at_rest(&Surface::of_grid(&grid), &material).expect("a valid material");
    for column in 0..64 {
        particles
            .set_inverse_mass((0, column), 0.0)
            .expect("it exists");
    }
    particles
        .set_velocity((32, 32), Vec3::Z)
        .expect("it exists");
    let step = TickStep {
        acceleration: 9.81 * Vec3::NEG_Y,
        ..STEP
    };
    let mut solver = Solver::new(&springs, &particles);
    for _ in 0..8 {
        solver.advance(&mut particles, step, &[], |_, _| false);
        let moves = || particles.displacements().map(|moved| moved.z.abs());
        assert!(moves().filter(|moved| *moved > 0.0).count() > 1);
        assert!(moves().all(|moved| moved == 0.0 || moved >= MIN_MOVE));
        let mut places = particles.positions().map(|at| at.z);
        assert!(places.all(|z| z == 0.0 || z.is_normal()));
    }
}
