//! Sub-steps, with no app around them.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    contact::{ContactSettings, Detection, MovingCollider, NarrowPhase},
    hierarchy::{BoundRule, BoundingVolume, NodeBounds, QuadTree, TopDownQuery},
    prelude::ClothCollider,
    solver::{
        Bending, ClothCreasing, Control, PinMotion, Solver, Stretch, Substepping, Tethers,
        TickStep,
        forces::{Air, ForceInputs},
    },
};
use stats_alloc::Region;

use crate::{ALLOCATOR, meshes};

pub fn a_step_does_not_allocate() {
    let material = ClothMaterial::COTTON;
    // Stiff enough to be solved.
    let stiff = ClothMaterial {
        bend_rigidity: 0.1,
        ..material
    };
    let grid = Cloth::new(40, 40, 0.05)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let surface = Arc::new(Surface::of_grid(&grid));
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
    for column in 0..40 {
        particles
            .set_inverse_mass((0, column), 0.0)
            .expect("it exists");
    }
    let springs = Springs::of_grid(&grid, &material);
    let list = Springs::of_list(&springs.to_vec(), particles.len()).expect("valid springs");
    let substepping = Substepping::Adaptive {
        stretch: 0.01,
        max_substeps: 60,
    };
    let ball = MovingCollider {
        turn: Vec3::Y * 0.1,
        // It touches the cloth: right in it, it would tear it.
        ..MovingCollider::ball(
            0.3,
            Vec3::new(1.0, -1.0, -0.29),
            Vec3::new(1.0, -1.0, -0.27),
        )
    };
    let mut settings = ContactSettings {
        particle_radius: 0.01,
        friction: 0.4,
        ..Default::default()
    };
    let tree = QuadTree::of_grid(&grid, true);
    let creasing = ClothCreasing {
        yield_curvature: 0.5,
        hardening: 0.3,
    };
    let pins = [PinMotion {
        particle: 0,
        from: Vec3::ZERO,
        to: Vec3::splat(0.01),
    }];
    // The list's particles lie as the grid's do; its sweep differs. The second time against triangles.
    for (springs, narrow_phase) in [
        (&springs, NarrowPhase::Particles),
        (&list, NarrowPhase::Triangles),
    ] {
        settings.narrow_phase = narrow_phase;
        let mut particles = particles.clone();
        let mut solver = Solver::new(springs, &particles);
        let mut detection = Detection::default();
        let mut query = TopDownQuery::default();
        let mut bounds = [const { None::<()> }; 3].map(|_| NodeBounds::default());
        let mut stretch = Stretch::measure(springs, &particles);
        let mut bending = Bending::new(&surface, &stiff).expect("it resists");
        bending.set_creasing(&surface, &stiff, Some(creasing));
        solver.set_bending(Some(bending));
        solver.set_tethers(Tethers::new(&surface, &material, &particles, 9.81));
        let mut control = Control::default();
        let mut pushed = 0.0_f32;
        let choices = [
            (BoundingVolume::Sphere, BoundRule::RestShape),
            (BoundingVolume::Aabb, BoundRule::Refit),
            (BoundingVolume::Obb, BoundRule::Refit),
        ];
        let mut ticks = |count: u32| {
            for _ in 0..count {
                let step = TickStep {
                    substeps: control.substeps(substepping, 20),
                    acceleration: Vec3::NEG_Y * 9.81,
                    ..Default::default()
                };
                let root = tree.root_sphere(&particles, stretch.bound);
                detection.begin(&surface, 50.0);
                let (probe, against) = detection.probe(&ball, &settings, &surface, 0.2, &root);
                for (bounds, choice) in bounds.iter_mut().zip(choices) {
                    query.clear();
                    let known = bounds.rebuild(choice, &tree, &particles, stretch.bound);
                    known.expect("there is such a rule");
                    query.search(&tree, bounds, &particles, &probe);
                }
                detection.add(0, &ball, against, query.candidates(), &particles);
                stretch = solver.advance(&mut particles, step, &pins, |particles, substep| {
                    detection.respond(particles, &settings, substep, |_| {})
                });
                assert_eq!(detection.requeries(), 0);
                pushed = pushed.max(
                    detection
                        .touches()
                        .first()
                        .map_or(0.0, |touch| touch.deepest),
                );
                let _ = control.observe(substepping, stretch);
            }
        };
        // The first tick makes room.
        ticks(1);
        let region = Region::new(ALLOCATOR);
        ticks(30);
        let change = region.change();
        assert_eq!(
            (change.allocations, change.reallocations),
            (0, 0),
            "{change:?}"
        );
        assert!(pushed > 0.0, "the ball was touched");
    }
}

/// A cloth that hangs against what has edges, which its triangles touch.
pub fn sharp_colliders_do_not_allocate() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| (corner - 0.3) * 0.6);
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    for collider in [
        ClothCollider::cuboid(0.6, 0.6, 0.6),
        ClothCollider::cylinder(0.3, 0.6),
        ClothCollider::convex_hull(corners.to_vec()),
        ClothCollider::trimesh(corners.to_vec(), faces),
    ] {
        let shape = collider.scaled(Vec3::ONE).expect("a shape");
        let grid = Cloth::new(30, 30, 0.05).grid(Vec3::ONE).expect("a grid");
        let surface = Arc::new(Surface::of_grid(&grid));
        let material = ClothMaterial::COTTON;
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a material");
        for column in 0..30 {
            let pinned = particles.set_inverse_mass((0, column), 0.0);
            pinned.expect("it exists");
        }
        let mut solver = Solver::new(&Springs::of_grid(&grid, &material), &particles);
        let settings = ContactSettings {
            particle_radius: 0.01,
            ..ContactSettings::default()
        };
        let place = Isometry3d::from_xyz(0.7, -0.7, -0.15);
        let collider = MovingCollider::still(shape, place);
        let all: Vec<u32> = (0..particles.len() as u32).collect();
        let mut detection = Detection::default();
        let mut pushed = 0.0_f32;
        let mut ticks = |count: u32| {
            for _ in 0..count {
                let step = TickStep {
                    acceleration: Vec3::NEG_Y * 9.81,
                    ..TickStep::default()
                };
                detection.begin(&surface, 50.0);
                let by = NarrowPhase::Triangles;
                detection.add(0, &collider, by, &all, &particles);
                solver.advance(&mut particles, step, &[], |particles, substep| {
                    detection.respond(particles, &settings, substep, |_| {})
                });
                let deepest = detection.touches().first().map(|touch| touch.deepest);
                pushed = pushed.max(deepest.unwrap_or_default());
            }
        };
        // Until it hangs still: what it has not been near before is remembered from then on.
        ticks(120);
        let region = Region::new(ALLOCATOR);
        ticks(30);
        let change = region.change();
        let made = (change.allocations, change.reallocations);
        assert_eq!(made, (0, 0), "{collider:?}: {change:?}");
        assert!(pushed > 0.0, "{collider:?} was touched");
    }
}

/// Rubber, which its forces push, with and without bending, and cotton with damping along its springs.
pub fn neither_forces_nor_damping_allocate() {
    let limp = ClothMaterial {
        bend_rigidity: 0.0,
        ..ClothMaterial::RUBBER
    };
    let damped = ClothMaterial {
        stretch_damping: 1.0e-3,
        ..ClothMaterial::COTTON
    };
    for material in [ClothMaterial::RUBBER, limp, damped] {
        let grid = Cloth::new(20, 20, 0.05).grid(Vec3::ONE).expect("a grid");
        let surface = Surface::of_grid(&grid);
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a material");
        particles.set_inverse_mass(0, 0.0).expect("it exists");
        let mut solver = Solver::new(&Springs::of_grid(&grid, &material), &particles);
        solver.set_bending(Bending::new(&surface, &material));
        solver.set_stretch_damping(material.stretch_damping);
        let step = TickStep {
            acceleration: Vec3::NEG_Y * 9.81,
            ..Default::default()
        };
        let is_explicit = solver.longest_explicit_substep(&particles) > step.seconds / 20.0;
        assert_eq!(is_explicit, material.stretch_compliance > 1.0e-3);
        let mut ticks = |count: u32| {
            for _ in 0..count {
                solver.advance(&mut particles, step, &[], |_, _| false);
            }
        };
        ticks(1);
        let region = Region::new(ALLOCATOR);
        ticks(10);
        let change = region.change();
        let made = (change.allocations, change.reallocations);
        assert_eq!(made, (0, 0), "{material:?}: {change:?}");
    }
}

pub fn a_mesh_does_not_allocate() {
    let material = ClothMaterial::COTTON;
    let mesh = meshes::irregular(1.0, 1.0, 1.0 / 30.0, 0.3);
    let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
    particles.set_inverse_mass(0, 0.0).expect("it exists");
    let springs = Springs::of_surface(&surface, &material);
    let mut solver = Solver::of_surface(&surface, &springs);
    let step = TickStep {
        acceleration: Vec3::NEG_Y * 9.81,
        ..TickStep::default()
    };
    let mut ticks = |count: u32| {
        for _ in 0..count {
            solver.advance(&mut particles, step, &[], |_, _| false);
        }
    };
    // The first tick makes room.
    ticks(1);
    let region = Region::new(ALLOCATOR);
    ticks(30);
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0));
}

/// In a wind of each place.
pub fn air_does_not_allocate() {
    let material = ClothMaterial::COTTON;
    let mesh = meshes::irregular(1.0, 1.0, 1.0 / 20.0, 0.3);
    let of_mesh = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
    let grid = Cloth::new(20, 20, 0.05).grid(Vec3::ONE).expect("a grid");
    for surface in [Surface::of_grid(&grid), of_mesh] {
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
        particles.set_inverse_mass(0, 0.0).expect("it exists");
        let mut solver = Solver::of_surface(&surface, &Springs::of_surface(&surface, &material));
        let air = Air {
            density: 1.2,
            drag: 1.2,
            ..Air::default()
        };
        let forces = ForceInputs {
            air: Some(air),
            ..ForceInputs::default()
        };
        let mut ticks = |count: u32| {
            for _ in 0..count {
                solver.forces.set(&surface, forces);
                solver
                    .forces
                    .set_local_wind(&particles, |place| place + Vec3::Z);
                solver.advance(&mut particles, TickStep::default(), &[], |_, _| false);
            }
        };
        ticks(20);
        let region = Region::new(ALLOCATOR);
        ticks(30);
        let change = region.change();
        assert_eq!((change.allocations, change.reallocations), (0, 0));
    }
}
