//! The solver's sub-steps and ticks by size, against the layout of a first draft.
//! `cargo bench --profile dev --bench solver`; an element is a spring in a sub-step.

mod shared;

use std::time::Duration;

use bevy::math::Vec3;
use bevy_drape::{
    cloth::ClothMaterial,
    solver::{
        Bending, ClothCreasing, SimdLevel, Solver,
        forces::{Air, ForceInputs},
    },
};
use criterion::{
    BatchSize, BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
    measurement::WallTime,
};
use shared::{Naive, SUBSTEPS, Scene, in_motion};

/// Times a tick of the library's own solver.
fn time(group: &mut BenchmarkGroup<WallTime>, id: BenchmarkId, scene: &Scene, solver: &mut Solver) {
    group.bench_function(id, |bencher| {
        bencher.iter_batched_ref(
            || scene.particles.clone(),
            |particles| solver.advance(particles, scene.step(SUBSTEPS), &[], |_, _| false),
            BatchSize::LargeInput,
        );
    });
}

fn sweeps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sub-steps");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for side in [8, 16, 32, 64, 128, 256, 512] {
        let scene = in_motion(side);
        group.throughput(Throughput::Elements(
            scene.springs.len() as u64 * u64::from(SUBSTEPS),
        ));
        for (name, simd_level) in [
            ("widest instructions", SimdLevel::Auto),
            ("baseline instructions", SimdLevel::Baseline),
        ] {
            let mut solver = scene.solver(false);
            solver.set_simd_level(simd_level);
            time(
                &mut group,
                BenchmarkId::new(name, side),
                &scene,
                &mut solver,
            );
        }
        for (name, is_coloured) in [("naive, row by row", false), ("naive, coloured", true)] {
            if side > 256 {
                continue;
            }
            group.bench_function(BenchmarkId::new(name, side), |bencher| {
                bencher.iter_batched_ref(
                    || Naive::new(&scene, is_coloured),
                    |naive| naive.tick(&scene, SUBSTEPS),
                    BatchSize::LargeInput,
                );
            });
        }
    }
    group.finish();
}

fn ticks(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tick");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for side in [16, 32, 64, 128, 256, 512] {
        let scene = in_motion(side);
        let mut solver = scene.solver(true);
        for partitions in [1, 2] {
            solver.set_partitions(partitions);
            let id = BenchmarkId::new(format!("{partitions} partitions"), side);
            time(&mut group, id, &scene, &mut solver);
        }
    }
    group.finish();
}

/// The time that bending, and creases in all of the cloth, add to a tick: an element is a particle in a sub-step.
fn bending(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bending");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for side in [16, 64, 128] {
        let scene = in_motion(side);
        group.throughput(Throughput::Elements(
            scene.particles.len() as u64 * u64::from(SUBSTEPS),
        ));
        for (name, material) in [
            ("none", None),
            ("cotton", Some(ClothMaterial::COTTON)),
            ("canvas", Some(ClothMaterial::CANVAS)),
        ] {
            let mut solver = scene.solver(false);
            solver.set_bending(material.and_then(|of| Bending::new(&scene.surface, &of)));
            time(
                &mut group,
                BenchmarkId::new(name, side),
                &scene,
                &mut solver,
            );
        }
    }
    for side in [16, 64, 128] {
        let scene = in_motion(side);
        group.throughput(Throughput::Elements(
            scene.particles.len() as u64 * u64::from(SUBSTEPS),
        ));
        for (name, yield_curvature) in [
            ("canvas that might crease", 1.0e6),
            ("canvas, creased", 1.0e-3),
        ] {
            let creasing = ClothCreasing {
                yield_curvature,
                hardening: 0.5,
            };
            let canvas = ClothMaterial::CANVAS;
            let mut bending = Bending::new(&scene.surface, &canvas).expect("it resists");
            bending.set_creasing(&scene.surface, &canvas, Some(creasing));
            let mut solver = scene.solver(false);
            solver.set_bending(Some(bending));
            time(
                &mut group,
                BenchmarkId::new(name, side),
                &scene,
                &mut solver,
            );
        }
    }
    group.finish();
}

/// What air adds to a tick: an element is a particle in a sub-step. A wind that is not the same everywhere is asked for in each tick.
fn air(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("air");
    group
        .sample_size(40)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    let breeze = Air {
        density: 1.2,
        drag: 1.2,
        lift: 1.5,
        wind: Vec3::new(2.0, 0.0, 8.0),
    };
    for side in [16, 64, 128] {
        let scene = in_motion(side);
        group.throughput(Throughput::Elements(
            scene.particles.len() as u64 * u64::from(SUBSTEPS),
        ));
        for (name, air, is_local) in [
            ("none", None, false),
            ("a wind", Some(breeze), false),
            ("a wind of each place", Some(breeze), true),
        ] {
            let mut solver = scene.solver(false);
            let forces = ForceInputs {
                air,
                ..ForceInputs::default()
            };
            solver.forces.set(&scene.surface, forces);
            group.bench_function(BenchmarkId::new(name, side), |bencher| {
                bencher.iter_batched_ref(
                    || scene.particles.clone(),
                    |particles| {
                        if is_local {
                            solver
                                .forces
                                .set_local_wind(particles, |place| breeze.wind + place);
                        }
                        solver.advance(particles, scene.step(SUBSTEPS), &[], |_, _| false)
                    },
                    BatchSize::LargeInput,
                );
            });
        }
    }
    group.finish();
}

criterion_group!(benches, sweeps, bending, air, ticks);
criterion_main!(benches);
