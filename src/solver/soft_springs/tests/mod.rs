//! Soft springs against the same ones in f64, partitions against one partition, and when they are chosen.

mod torn;

use bevy::math::{DVec3, Isometry3d, Vec3};

use super::*;
use crate::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Spring, SpringStorage, Springs, Surface},
    solver::{
        bending::Bending,
        kernels::SimdLevel,
        step::{TickStep, TimeOrder},
        substep::Solver,
        substepping::Substepping,
    },
};

/// Neither bending nor damping, and soft.
const SOFT: ClothMaterial = ClothMaterial {
    areal_density: 0.15,
    stretch_compliance: 1.0e-3,
    shear_compliance: 2.0e-3,
    bend_rigidity: 0.0,
    weft: None,
    stiffening: None,
    stretch_damping: 0.0,
    damping: 0.0,
    friction: 0.0,
};

fn grid(columns: u32, rows: u32) -> ClothGrid {
    Cloth::new(columns, rows, 0.1)
        .grid(Vec3::new(1.0, 1.2, 1.0))
        .expect("a valid grid")
}

/// A cloth that is crumpled and moves, one particle pinned.
fn crumpled(grid: &ClothGrid, material: &ClothMaterial) -> (ClothParticles, Solver) {
    let surface = Surface::of_grid(grid);
    let mut particles = ClothParticles::at_rest(&surface, material).expect("a valid material");
    for (row, column) in grid.cells() {
        let at = (row * 31 + column * 7) as f32;
        let noise = 0.02 * Vec3::new(at.sin(), (2.0 * at).cos(), (3.0 * at).sin());
        let place = grid.rest_position(row, column) + noise;
        particles
            .set_position((row, column), place)
            .and_then(|()| particles.set_velocity((row, column), 20.0 * noise))
            .expect("it exists");
    }
    particles.set_inverse_mass((0, 0), 0.0).expect("it exists");
    let springs = Springs::of_grid(grid, material);
    let mut solver = Solver::new(&springs, &particles);
    solver.set_bending(Bending::new(&surface, material));
    (particles, solver)
}

/// Velocity Verlet in f64, with roots, spring after spring.
struct Twin {
    places: Vec<DVec3>,
    velocities: Vec<DVec3>,
    inverse_masses: Vec<f64>,
    springs: Vec<Spring>,
}

impl Twin {
    fn of(particles: &ClothParticles, springs: &Springs) -> Self {
        let velocity = |at: usize| match particles.is_pinned(at).expect("it exists") {
            true => DVec3::ZERO,
            false => particles.velocity(at).expect("it exists").as_dvec3(),
        };
        Self {
            places: particles.positions().map(Vec3::as_dvec3).collect(),
            velocities: (0..particles.len()).map(velocity).collect(),
            inverse_masses: particles.inverse_masses().map(f64::from).collect(),
            springs: springs.to_vec(),
        }
    }

    fn kick(&mut self, seconds: f64, gravity: DVec3) {
        let mut forces = vec![DVec3::ZERO; self.places.len()];
        for spring in &self.springs {
            let [a, b] = spring.ends.map(|end| end as usize);
            let span = self.places[b] - self.places[a];
            let over = 1.0 - f64::from(spring.rest_length) / span.length();
            let force = span * (over / f64::from(spring.compliance));
            forces[a] += force;
            forces[b] -= force;
        }
        for ((velocity, force), weight) in self
            .velocities
            .iter_mut()
            .zip(forces)
            .zip(&self.inverse_masses)
        {
            if *weight > 0.0 {
                *velocity += (force * *weight + gravity) * seconds;
            }
        }
    }

    fn tick(&mut self, step: &TickStep) {
        let dt = f64::from(step.seconds) / f64::from(step.substeps);
        for _ in 0..step.substeps {
            self.kick(0.5 * dt, step.acceleration.as_dvec3());
            for (place, velocity) in self.places.iter_mut().zip(&self.velocities) {
                *place += *velocity * dt;
            }
            self.kick(0.5 * dt, step.acceleration.as_dvec3());
        }
    }
}

fn step(substeps: u32) -> TickStep {
    TickStep {
        substeps,
        acceleration: Vec3::new(0.3, -9.81, 0.2),
        ..TickStep::default()
    }
}

/// On all kinds of strips, with and without diagonals. Springs are up to 0.35 too long, where a force is off by 4·10⁻⁴ of itself
/// (see `force`), of at most 40 N, on 0.9 to 3.6 g (an inner particle or a corner): 4 m/s² of 10⁴, over a tick of 1/64 s no more than
/// 5·10⁻⁴ m, in springs that swing twenty times in it so that most of that cancels. 10⁻⁵ m was found; 10⁻⁴ is allowed.
#[test]
fn a_tick_is_that_of_a_plain_solver_in_f64() {
    for (columns, rows) in [(2, 2), (5, 4), (16, 9), (33, 6), (70, 3)] {
        for shear_compliance in [2.0e-3, f32::INFINITY] {
            let material = ClothMaterial {
                shear_compliance,
                ..SOFT
            };
            let grid = grid(columns, rows);
            let springs = Springs::of_grid(&grid, &material);
            let (mut particles, mut solver) = crumpled(&grid, &material);
            let mut twin = Twin::of(&particles, &springs);
            let step = step(40);
            solver.advance(&mut particles, step, &[], |_, _| false);
            twin.tick(&step);
            let apart = particles
                .positions()
                .zip(&twin.places)
                .map(|(ours, its)| ours.as_dvec3().distance(*its));
            let apart = apart.fold(0.0, f64::max);
            let velocity = |at| particles.velocity(at).expect("it exists").as_dvec3();
            // The first one is pinned.
            let faster = (1..particles.len())
                .map(|at| velocity(at).distance(twin.velocities[at]))
                .fold(0.0, f64::max);
            println!("{columns} × {rows}, {shear_compliance}: {apart:.1e} m, {faster:.1e} m/s");
            assert!(apart < 1.0e-4, "{columns} × {rows}: {apart}");
            // The fastest swing turns 1e-4 m into ω times as much, ω = 1,500/s.
            assert!(faster < 0.15, "{columns} × {rows}: {faster}");
        }
    }
}

/// However many partitions and whatever instructions: the same bits, of a whole grid and of a torn one.
#[test]
fn partitions_and_simd_levels_change_no_bit() {
    for is_torn in [false, true] {
        check_bits(is_torn);
    }
}

fn check_bits(is_torn: bool) {
    let bits = |partitions: usize, simd_level: SimdLevel| -> Vec<u32> {
        let material = ClothMaterial {
            bend_rigidity: 1.0e-6,
            ..SOFT
        };
        let (mut particles, mut solver) = if is_torn {
            let (particles, _, solver) = torn::crumpled_and_torn(37, 130, &material, 0.02);
            (particles, solver)
        } else {
            crumpled(&grid(37, 130), &material)
        };
        let step = step(if is_torn { 120 } else { 60 });
        solver.set_partitions(partitions);
        solver.set_simd_level(simd_level);
        assert_eq!(solver.explicit_partitions(), partitions.min(4));
        assert!(solver.is_explicit(&particles, &step));
        for _ in 0..3 {
            solver.advance(&mut particles, step, &[], |_, _| false);
        }
        let positions = particles.positions().chain(particles.displacements());
        positions
            .flat_map(|place| place.to_array().map(f32::to_bits))
            .collect()
    };
    let plain = bits(1, SimdLevel::Baseline);
    for partitions in [1, 2, 3, 4, 9] {
        assert!(
            bits(partitions, SimdLevel::Auto) == plain,
            "{partitions} partitions, torn: {is_torn}"
        );
    }
}

/// A rope has no springs to a row below: ω² = 4 k ⁄ m, as of a chain, and its limit is that of twice as much.
#[test]
fn the_limit_of_a_rope_is_that_of_a_chain() {
    let surface = Cloth::rope(16, 0.1, 0.01).surface(Vec3::ONE);
    let surface = surface.expect("a rope");
    let grid = surface.as_grid().expect("a row");
    let springs = Springs::of_grid(grid, &SOFT);
    let particles = ClothParticles::at_rest(&surface, &SOFT).expect("a valid material");
    let SpringStorage::Grid(grid, compliances) = springs.storage() else {
        panic!("a grid's");
    };
    let springs = SoftSprings::new(grid, compliances).expect("soft springs");
    let (width, length) = (0.02, 0.1);
    let stiffness = width / (length * 1.0e-3);
    let square = 4.0 * stiffness / (0.15 * width * length);
    let longest = 0.95 * 2.0 / f32::sqrt(square);
    let found = springs.longest_substep(particles.blocks());
    assert!((found / longest - 1.0).abs() < 1.0e-5, "{found} {longest}");
}

/// Of a flat lattice the fastest swing is known: each particle against all its neighbours, ω² = 4 w (k + k′) for a square one
/// of stiffness k and k′ along its diagonals.
/// The limit is that of twice as much, and of 0.95 of the longest step for it.
#[test]
fn the_limit_is_that_of_the_stiffest_particle() {
    let grid = Cloth::new(16, 16, 0.1).grid(Vec3::ONE).expect("a grid");
    let springs = Springs::of_grid(&grid, &SOFT);
    let mut particles =
        ClothParticles::at_rest(&Surface::of_grid(&grid), &SOFT).expect("a valid material");
    let SpringStorage::Grid(grid, compliances) = springs.storage() else {
        panic!("a grid's");
    };
    let springs = SoftSprings::new(grid, compliances).expect("soft springs");
    let mass = 0.15 * 0.1 * 0.1;
    let square = 8.0 / mass * (1.0 / 1.0e-3 + 1.0 / 2.0e-3_f32);
    let longest = 0.95 * 2.0 / square.sqrt();
    let mut at = |away: f32| {
        particles.transform(Isometry3d::from_translation(away * Vec3::X));
        let found = springs.longest_substep(particles.blocks());
        particles.transform(Isometry3d::from_translation(-away * Vec3::X));
        found
    };
    let found = at(0.0);
    assert!((found / longest - 1.0).abs() < 1.0e-5, "{found} {longest}");
    // Where rounding is as large as is allowed.
    let rounding = (0.08 * 9.81 * 0.1 * longest / square).sqrt();
    let farthest = rounding * 12.0_f32.sqrt() / f32::EPSILON;
    assert!(at(0.98 * farthest - 1.5) > 0.0, "{farthest}");
    assert_eq!(at(1.02 * farthest - 1.5), 0.0, "{farthest}");
}

/// Rigid springs have no forces, and nor do those for which chains are cheaper.
#[test]
fn forces_are_for_soft_springs() {
    let seconds = 1.0 / 64.0;
    let needed = |side: u32, material: &ClothMaterial| {
        let grid = Cloth::new(side, side, 2.0 / side as f32).grid(Vec3::ONE);
        let grid = grid.expect("a grid");
        let surface = Surface::of_grid(&grid);
        let particles = ClothParticles::at_rest(&surface, material).expect("a valid material");
        let mut solver = Solver::new(&Springs::of_grid(&grid, material), &particles);
        solver.set_bending(Bending::new(&surface, material));
        let needed = |order| solver.needed(&particles, side as usize, seconds, order);
        let substeps = needed(TimeOrder::Second);
        let by_chains = Substepping::needed(side as usize, seconds);
        assert_eq!(needed(TimeOrder::First), by_chains);
        let is_explicit = |substeps: u32, order: TimeOrder| {
            let step = TickStep {
                order,
                ..step(substeps)
            };
            solver.is_explicit(&particles, &step)
        };
        assert!(!is_explicit(substeps, TimeOrder::First));
        (substeps, is_explicit(substeps, TimeOrder::Second))
    };
    for side in [8, 16, 32, 64, 128] {
        let by_chains = Substepping::needed(side as usize, seconds);
        assert_eq!(needed(side, &ClothMaterial::COTTON), (by_chains, false));
        let (substeps, is_explicit) = needed(side, &ClothMaterial::RUBBER);
        assert!(
            is_explicit && substeps <= 2 * by_chains,
            "{side}: {substeps}"
        );
        // Too stiff to bend by forces.
        let board = ClothMaterial {
            bend_rigidity: 1.0e3,
            ..ClothMaterial::RUBBER
        };
        assert_eq!(needed(side, &board), (by_chains, false));
    }
}

/// A particle that a game throws 3 m out of its cloth comes back, and the cloth to rest: no spring is too long for its force.
#[test]
fn what_is_torn_out_comes_back() {
    let (mut particles, mut solver) = crumpled(&grid(16, 16), &SOFT);
    let step = TickStep {
        damping: 0.05,
        ..step(40)
    };
    particles
        .set_position((8, 8), Vec3::new(0.0, 3.0, 0.0))
        .expect("it exists");
    assert!(solver.is_explicit(&particles, &step));
    for _ in 0..640 {
        solver.advance(&mut particles, step, &[], |_, _| false);
    }
    let stretch = solver.measure(&particles).structural;
    assert!(stretch < 0.2, "{stretch}");
}
