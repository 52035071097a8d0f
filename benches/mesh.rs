//! A cloth from a mesh beside the same cloth from a grid: a sub-step, a search, the building, and ticks of an app; and a
//! fine mesh that is driven by a coarse cloth. Also ticks of a grid that may tear, is torn, or is mapped.
//! `cargo bench --profile dev --bench mesh`; in `sub-steps` an element is a spring in a sub-step.

#[path = "../tests/shared/meshes.rs"]
mod meshes;

use std::time::{Duration, Instant};

use bevy::{
    MinimalPlugins, app::App, ecs::world::EntityWorldMut, math::Vec3, time::TimeUpdateStrategy,
    transform::TransformPlugin,
};
/// What `meshes` calls the crate, whose own tests read it, too.
use bevy_drape as library;
use bevy_drape::{
    cloth::{
        Cloth, ClothFactor, ClothMaterial, ClothMaterialMap, ClothPaint, ClothParticles,
        ClothTearing, ClothTears, Pin, Pins, Springs, Surface, SurfaceBinding, TriangleMesh,
    },
    hierarchy::{BoundRule, BoundingVolume, NodeBounds, Probe, QuadTree, TopDownQuery},
    prelude::{ClothAsyncBuild, ClothSettings, DrapePlugins},
    solver::{ClothCreasing, Solver, TickStep},
};
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// Vertices along either side: 5,041 in all, and how far apart they are (m).
const SIDE: u32 = 71;
const SPACING: f32 = 2.0 / (SIDE - 1) as f32;
const SUBSTEPS: u32 = 20;
const MATERIAL: ClothMaterial = ClothMaterial::COTTON;

/// A grid, a mesh of the same triangles, and an irregular one of as many vertices.
fn surfaces() -> [(&'static str, Surface); 3] {
    let cloth = Cloth::new(SIDE, SIDE, SPACING);
    let of = |mesh: &TriangleMesh| Surface::of_mesh(mesh, 1.0e-5, Vec3::ONE).expect("a surface");
    [
        ("grid", cloth.surface(Vec3::ONE).expect("a valid grid")),
        (
            "grid-shaped mesh",
            of(&meshes::regular(SIDE, SIDE, SPACING)),
        ),
        (
            "irregular mesh",
            of(&meshes::irregular(2.0, 2.0, SPACING, 0.3)),
        ),
    ]
}

/// Hung by its upper edge and blown at, a third of a second into its swing: not flat, and no number tiny.
fn in_motion(surface: &Surface) -> (Springs, ClothParticles, TickStep) {
    let springs = Springs::of_surface(surface, &MATERIAL);
    let mut particles = ClothParticles::at_rest(surface, &MATERIAL).expect("a valid material");
    for (index, place) in surface.rest_positions().iter().enumerate() {
        if place.y > -1.0e-4 {
            particles.set_inverse_mass(index, 0.0).expect("a particle");
        }
    }
    let step = TickStep {
        substeps: SUBSTEPS,
        acceleration: Vec3::new(0.5, -9.81, 2.0),
        damping: MATERIAL.damping,
        ..TickStep::default()
    };
    let mut solver = Solver::of_surface(surface, &springs);
    for _ in 0..20 {
        solver.advance(&mut particles, step, &[], |_, _| false);
    }
    (springs, particles, step)
}

fn substeps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sub-steps");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    for (name, surface) in surfaces() {
        let (springs, particles, step) = in_motion(&surface);
        let mut solver = Solver::of_surface(&surface, &springs);
        group.throughput(Throughput::Elements(
            springs.len() as u64 * u64::from(SUBSTEPS),
        ));
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter_batched_ref(
                || particles.clone(),
                |particles| solver.advance(particles, step, &[], |_, _| false),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

/// A ball of four spacings that touches the middle.
fn searches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("search");
    group
        .sample_size(30)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for (name, surface) in surfaces() {
        let (springs, particles, _) = in_motion(&surface);
        let tree = QuadTree::of_surface(&surface, true);
        let stretch = Solver::of_surface(&surface, &springs)
            .measure(&particles)
            .bound;
        let middle = particles
            .positions()
            .nth(surface.len() / 2)
            .expect("a particle");
        let probe = Probe::ball(middle, 4.0 * SPACING, 0.01);
        for choice in [
            (BoundingVolume::Sphere, BoundRule::RestShape),
            (BoundingVolume::Aabb, BoundRule::Refit),
        ] {
            let mut bounds = NodeBounds::default();
            let mut query = TopDownQuery::default();
            let id = BenchmarkId::new(name, format!("{}, {}", choice.0.name(), choice.1.name()));
            group.bench_function(id, |bencher| {
                bencher.iter(|| {
                    bounds
                        .rebuild(choice, &tree, &particles, stretch)
                        .expect("a rule");
                    query.clear();
                    query.search(&tree, &bounds, &particles, &probe)
                });
            });
        }
    }
    group.finish();
}

/// From the vertices and triangles of an asset to what the first tick needs.
fn building(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("building");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    let mesh = meshes::irregular(2.0, 2.0, SPACING, 0.3);
    group.bench_function("irregular mesh", |bencher| {
        bencher.iter(|| {
            let surface = Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a surface");
            let springs = Springs::of_surface(&surface, &MATERIAL);
            let tree = QuadTree::of_surface(&surface, true);
            let solver = Solver::of_surface(&surface, &springs);
            (surface, springs, tree, solver)
        });
    });
    group.finish();
}

/// A fine mesh of 5,041 vertices, with normals and tangents, on a cloth of 1,024 particles: where its vertices are, written into three
/// arrays; and binding it.
fn render_meshes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("render mesh");
    group
        .sample_size(30)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    let coarse = Cloth::new(32, 32, 2.0 / 31.0).surface(Vec3::ONE);
    let coarse = coarse.expect("a valid grid");
    let fine = meshes::irregular(2.0, 2.0, SPACING, 0.3);
    let tangents = vec![Vec3::X; fine.positions.len()];
    let bind = || SurfaceBinding::new(&coarse, &fine.positions, &fine.normals, &tangents);
    let binding = bind().expect("in its place");
    let (_, particles, _) = in_motion(&coarse);
    let positions: Vec<Vec3> = particles.positions().collect();
    let mut normals = Vec::new();
    let mut written = [
        vec![[0.0_f32; 3]; binding.len()],
        vec![[0.0; 3]; binding.len()],
    ];
    let mut tangents = vec![[0.0_f32; 4]; binding.len()];
    group.bench_function("5,041 vertices on 1,024 particles", |bencher| {
        bencher.iter(|| {
            coarse.normals_at(&positions, &mut normals);
            let [places, facing] = &mut written;
            binding.write(&positions, &normals, places, facing, &mut tangents);
        });
    });
    group.bench_function("binding them", |bencher| bencher.iter(bind));
    group.finish();
}

/// An app that updates by a tick.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / 64.0,
    )));
    app.finish();
    app.cleanup();
    // Time begins to run.
    app.update();
    app
}

/// Cloths of 4,096 particles that hang by two corners: a grid, a mesh of squares, half a pipe of such, and irregular ones.
fn hung() -> [(&'static str, Cloth, Pins); 5] {
    const SIDE: u32 = 64;
    let spacing = 2.0 / (SIDE - 1) as f32;
    let corners = Pins::new([Pin::Vertex(0), Pin::Vertex(SIDE as usize - 1)]);
    let of = |mesh: TriangleMesh| Cloth::triangles(mesh.positions, mesh.triangles);
    let mut pipe = meshes::regular(SIDE, SIDE, spacing);
    for place in &mut pipe.positions {
        let angle = place.x * std::f32::consts::FRAC_PI_2;
        place.x = -angle.cos() * std::f32::consts::FRAC_2_PI;
        place.z = angle.sin() * std::f32::consts::FRAC_2_PI;
    }
    let irregular = |jitter: f32| of(meshes::irregular(2.0, 2.0, spacing, jitter));
    [
        (
            "grid",
            Cloth::new(SIDE, SIDE, spacing),
            Pins::new([Pin::Index(0), Pin::Index(SIDE as usize - 1)]),
        ),
        (
            "mesh of squares",
            of(meshes::regular(SIDE, SIDE, spacing)),
            corners.clone(),
        ),
        ("half a pipe of squares", of(pipe), corners.clone()),
        ("irregular mesh, 0.15", irregular(0.15), corners.clone()),
        ("irregular mesh, 0.3", irregular(0.3), corners),
    ]
}

/// A tick of an app with one cloth, from its fall on; and the same with other factors of its material in each tick.
fn ticks(criterion: &mut Criterion) {
    let awake = ClothSettings {
        sleeps: false,
        ..Default::default()
    };
    let mut group = criterion.benchmark_group("tick of 4,096");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(2));
    for (name, cloth, pins) in hung() {
        let mut app = app();
        app.world_mut().spawn((cloth, pins, awake));
        group.bench_function(name, |bencher| bencher.iter(|| app.update()));
    }
    let changes: [(&str, fn(f32) -> ClothMaterialMap); 3] = [
        ("density", |factor| ClothMaterialMap {
            density: ClothFactor::of(factor),
            ..Default::default()
        }),
        ("stretch", |factor| ClothMaterialMap {
            stretch: ClothFactor::of(factor),
            ..Default::default()
        }),
        ("bending", |factor| ClothMaterialMap {
            bending: ClothFactor::of(factor),
            ..Default::default()
        }),
    ];
    for (name, map) in changes {
        let [.., (_, cloth, pins)] = hung();
        let mut app = app();
        let cloth = app.world_mut().spawn((cloth, pins, map(1.0), awake)).id();
        let mut count = 0;
        group.bench_function(format!("irregular mesh, 0.3, other {name}"), |bencher| {
            bencher.iter(|| {
                count += 1;
                let changed = map(1.0 + 0.1 * (count as f32).sin());
                app.world_mut().entity_mut(cloth).insert(changed);
                app.update();
            });
        });
    }
    group.finish();
}

/// A grid that may change: what a tick of it costs without, with what is not used, and with what is.
fn changes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tick of a 64² grid");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(2));
    let awake = ClothSettings {
        sleeps: false,
        ..Default::default()
    };
    let [(_, grid, pins), ..] = hung();
    // Half of a row in its middle.
    let slit = (32 * 64 + 16..32 * 64 + 48).map(|at| [at, at + 1]);
    let mut torn = ClothTears::default();
    torn.tear_all(slit);
    let softer = ClothPaint::at_rest(|place| if place.y < -1.0 { 0.5 } else { 1.0 });
    let map = ClothMaterialMap {
        stretch: ClothFactor::of(softer),
        ..Default::default()
    };
    let never = ClothCreasing {
        yield_curvature: 1.0e6,
        hardening: 0.5,
    };
    let insert: [(&str, &dyn Fn(&mut EntityWorldMut)); 7] = [
        ("as it is", &|_| {}),
        ("may be cut", &|cloth| {
            cloth.insert(ClothTears::default());
        }),
        ("may tear", &|cloth| {
            cloth.insert(ClothTearing::new(1.0e6));
        }),
        ("torn", &|cloth| {
            cloth.insert(torn.clone());
        }),
        ("mapped", &|cloth| {
            cloth.insert(map.clone());
        }),
        ("may crease", &|cloth| {
            cloth.insert(never);
        }),
        ("as it is, again", &|_| {}),
    ];
    for (name, insert) in insert {
        let mut app = app();
        let cloth = (grid.clone(), pins.clone(), awake);
        insert(&mut app.world_mut().spawn(cloth));
        (0..60).for_each(|_| app.update());
        group.bench_function(name, |bencher| bencher.iter(|| app.update()));
    }
    group.finish();
}

/// The longest tick from where a mesh of 4,096 vertices is spawned to where it moves.
fn first_ticks(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("longest of the first ticks of 4,096");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    let [.., (_, cloth, pins)] = hung();
    for (name, is_async) in [("at once", false), ("in the background", true)] {
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|times| {
                let longest = || {
                    let mut app = app();
                    let cloth = app.world_mut().spawn((cloth.clone(), pins.clone())).id();
                    if is_async {
                        app.world_mut().entity_mut(cloth).insert(ClothAsyncBuild);
                    }
                    let mut longest = Duration::ZERO;
                    let is_built = |app: &App| {
                        let particles = app.world().get::<ClothParticles>(cloth);
                        particles.is_some_and(|particles| !particles.is_empty())
                    };
                    while !is_built(&app) {
                        let begin = Instant::now();
                        app.update();
                        longest = longest.max(begin.elapsed());
                        std::thread::sleep(Duration::from_millis(2));
                    }
                    longest
                };
                (0..times).map(|_| longest()).sum()
            });
        });
    }
    group.finish();
}

criterion_group!(
    benches,
    substeps,
    searches,
    building,
    render_meshes,
    ticks,
    changes,
    first_ticks
);
criterion_main!(benches);
