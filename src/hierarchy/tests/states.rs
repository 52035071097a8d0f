//! Random states of a cloth with a collider near it.

use bevy::math::{Isometry3d, Quat, Vec3};
use proptest::{
    prelude::*,
    test_runner::{Config, RngAlgorithm, TestRng, TestRunner},
};

use crate::{
    cloth::{Cloth, ClothMaterial, ClothParticles, SpringKind, Springs, Surface},
    hierarchy::{
        bounds::NodeBounds,
        probe::{Core, Probe},
        query::TopDownQuery,
        rule::BoundRule,
        tree::QuadTree,
        volume::BoundingVolume,
    },
    solver::Stretch,
};

/// A cloth in some state, and a collider near it.
#[derive(Debug, Clone)]
pub struct State {
    pub columns: u32,
    pub rows: u32,
    pub diagonals: bool,
    /// As a list of springs between particles in a row, and its tree.
    pub is_network: bool,
    /// How the particles are moved from rest, in spacings: waves, a fold, and each by itself.
    pub waves: Vec3,
    pub folded: bool,
    pub noise: f32,
    pub seed: u64,
    pub core: CoreKind,
    /// Length of the core in spacings.
    pub size: f32,
    /// Radius in spacings, and the particle that it is near to, how near in radii, and from where.
    pub radius: f32,
    pub near: usize,
    pub distance: f32,
    pub direction: Vec3,
    pub particle_radius: f32,
    /// How far from the origin all of this happens, in spacings.
    pub origin: Vec3,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CoreKind {
    Ball,
    Capsule,
    Cuboid,
    HalfSpace,
}

const SPACING: f32 = 0.1;

pub fn states() -> impl Strategy<Value = State> {
    let within = |limit: f32| (-limit..limit, -limit..limit, -limit..limit).prop_map(Vec3::from);
    let grid = (
        2u32..36,
        2u32..36,
        any::<bool>(),
        (0..8).prop_map(|network| network == 0),
    );
    let noise = prop_oneof![Just(0.0f32), 0.0f32..0.5, 0.0f32..8.0];
    let shape = (within(6.0), any::<bool>(), noise, any::<u64>());
    let radius = prop_oneof![0.05f32..1.0, 1.0f32..12.0];
    let core = prop_oneof![
        5 => Just(CoreKind::Ball),
        2 => Just(CoreKind::Capsule),
        2 => Just(CoreKind::Cuboid),
        1 => Just(CoreKind::HalfSpace),
    ];
    let collider = (
        radius,
        any::<usize>(),
        0.0f32..1.6,
        within(1.0),
        0.0f32..0.3,
        core,
        0.0f32..8.0,
    );
    let origin = prop_oneof![Just(Vec3::ZERO), within(1.0e4)];
    (grid, shape, collider, origin).prop_map(
        |(
            (columns, rows, diagonals, is_network),
            (waves, folded, noise, seed),
            (radius, near, distance, direction, particle_radius, core, size),
            origin,
        )| State {
            columns,
            rows,
            diagonals,
            is_network,
            waves,
            folded,
            noise,
            seed,
            core,
            size,
            radius,
            near,
            distance,
            direction,
            particle_radius,
            origin,
        },
    )
}

/// A runner whose states differ from those of other seeds, and are the same each time.
pub fn runner(seed: u64) -> TestRunner {
    let mut bytes = [7; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    TestRunner::new_with_rng(
        Config::default(),
        TestRng::from_seed(RngAlgorithm::ChaCha, &bytes),
    )
}

/// A state, built.
pub struct Scene {
    pub tree: QuadTree,
    pub particles: ClothParticles,
    pub stretch: Stretch,
    pub probe: Probe,
}

impl State {
    /// A cloth at rest, with a ball of one spacing beside its corner.
    pub fn flat(columns: u32, rows: u32) -> Self {
        Self {
            columns,
            rows,
            diagonals: true,
            is_network: false,
            waves: Vec3::ZERO,
            folded: false,
            noise: 0.0,
            seed: 0,
            core: CoreKind::Ball,
            size: 0.0,
            radius: 1.0,
            near: 0,
            distance: 0.9,
            direction: Vec3::new(-1.0, 1.0, 0.0),
            particle_radius: 0.0,
            origin: Vec3::ZERO,
        }
    }

    pub fn build(&self) -> Scene {
        let grid = Cloth::new(self.columns, self.rows, SPACING)
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let material = ClothMaterial {
            shear_compliance: if self.diagonals { 0.0 } else { f32::INFINITY },
            ..ClothMaterial::COTTON
        };
        let mut particles =
            ClothParticles::at_rest(&Surface::of_grid(&grid), &material).expect("a valid material");
        let rest: Vec<Vec3> = particles.positions().collect();
        let mut seed = self.seed;
        let mut random = || {
            // SplitMix64.
            seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let z = (seed ^ (seed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 23) as f32 - 1.0
        };
        for (row, column) in grid.cells() {
            let rest = grid.rest_position(row, column);
            let phase = Vec3::new(
                row as f32 * 0.4,
                column as f32 * 0.3,
                (row + column) as f32 * 0.2,
            );
            let mut moved =
                rest + Vec3::from(phase.to_array().map(f32::sin)) * self.waves * SPACING;
            if self.folded && row > self.rows / 2 {
                moved.y = -moved.y;
            }
            if self.noise > 0.0 {
                moved += Vec3::new(random(), random(), random()) * self.noise * SPACING;
            }
            particles
                .set_position((row, column), moved + self.origin * SPACING)
                .expect("it exists");
        }
        let springs = Springs::of_grid(&grid, &material);
        let stretch = Stretch::measure(&springs, &particles);
        let tree = if self.is_network {
            let positions: Vec<Vec3> = particles.positions().collect();
            let masses: Vec<f32> = particles.inverse_masses().collect();
            particles = ClothParticles::new(&positions, &masses).expect("valid particles");
            QuadTree::of_network(&rest, &springs.to_vec())
        } else {
            QuadTree::of_grid(&grid, springs.has(SpringKind::Shear))
        };
        Scene {
            probe: self.probe(&particles),
            tree,
            particles,
            stretch,
        }
    }

    /// A collider near a particle.
    pub fn probe(&self, particles: &ClothParticles) -> Probe {
        let near = particles
            .position(self.near % particles.len())
            .expect("it exists");
        let radius = self.radius * SPACING;
        let direction = self.direction.normalize_or(Vec3::Z);
        let centre = near + direction * radius * self.distance;
        let rotation = Quat::from_scaled_axis(self.direction * 3.0);
        let half = rotation * Vec3::X * self.size * SPACING;
        Probe {
            core: match self.core {
                CoreKind::Ball => Core::Point(centre),
                CoreKind::Capsule => Core::Segment([centre - half, centre + half]),
                CoreKind::Cuboid => Core::Cuboid {
                    pose: Isometry3d::new(centre, rotation),
                    half_size: Vec3::new(1.0, 0.1, 0.6) * self.size * SPACING,
                },
                CoreKind::HalfSpace => Core::HalfSpace {
                    point: centre,
                    normal: direction,
                },
            },
            radius,
            particle_radius: self.particle_radius * SPACING,
        }
    }
}

impl Scene {
    pub fn rebuild(&self, bounds: &mut NodeBounds, choice: (BoundingVolume, BoundRule)) {
        bounds
            .rebuild(choice, &self.tree, &self.particles, self.stretch.bound)
            .expect("there is such a rule");
    }

    /// What the probe meets, sorted.
    pub fn found(&self, query: &mut TopDownQuery, bounds: &NodeBounds) -> Vec<u32> {
        let found = query.search(&self.tree, bounds, &self.particles, &self.probe);
        let mut found = query.candidates()[found].to_vec();
        found.sort_unstable();
        found
    }
}
