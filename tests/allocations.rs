//! A step of the solver allocates nothing. Alone in its program: the count is of all threads.

use std::alloc::System;

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs},
    contact::{MovingBall, push_out},
    solver::{Control, PinMotion, Precision, Solver, Tethers, TickStep},
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

#[test]
fn a_step_does_not_allocate() {
    let material = ClothMaterial::COTTON;
    let grid = Cloth::new(40, 40, 0.05)
        .grid(Vec3::ONE)
        .expect("a sound grid");
    let mut particles = ClothParticles::at_rest(&grid, &material).expect("a sound material");
    for column in 0..40 {
        particles
            .set_inverse_mass((0, column), 0.0)
            .expect("it exists");
    }
    let springs = Springs::of_grid(&grid, &material);
    let list = Springs::of_list(&springs.to_vec(), particles.len()).expect("sound springs");
    let precision = Precision::Tolerance {
        stretch: 0.01,
        most_substeps: 60,
    };
    let ball = MovingBall {
        from: Vec3::new(1.0, -1.0, 0.0),
        to: Vec3::new(1.0, -1.0, 0.02),
        turn: Vec3::Y * 0.1,
        radius: 0.3,
    };
    let pins = [PinMotion {
        particle: 0,
        from: Vec3::ZERO,
        to: Vec3::splat(0.01),
    }];
    let candidates: Vec<u32> = (0..1600).collect();
    let mut touched = vec![false; 1600];
    for springs in [&springs, &list] {
        let mut solver = Solver::new(springs, &particles);
        solver.set_tethers(Tethers::new(&grid, &material, &particles, 9.81));
        let mut control = Control::default();
        let mut pushed = 0.0_f32;
        let mut ticks = |count: u32| {
            for _ in 0..count {
                let step = TickStep {
                    substeps: control.substeps(precision),
                    acceleration: Vec3::NEG_Y * 9.81,
                    ..Default::default()
                };
                let stretch = solver.advance(&mut particles, step, &pins, |particles, substep| {
                    let depth = push_out(
                        particles,
                        &candidates,
                        &mut touched,
                        &ball,
                        0.01,
                        0.4,
                        substep,
                    );
                    pushed = pushed.max(depth);
                    depth > 0.0
                });
                let _ = control.observe(precision, stretch);
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
