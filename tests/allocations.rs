//! A tick allocates nothing, neither its search nor its sub-steps. Alone in its program: the count is of all threads.

use std::{alloc::System, sync::Arc};

use bevy::{
    app::Plugins,
    asset::RenderAssetUsages,
    ecs::schedule::SingleThreadedExecutor,
    math::Vec3,
    mesh::{
        Indices, MeshPlugin, PrimitiveTopology, VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    time::TimeUpdateStrategy,
};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    contact::{ContactSettings, Detection, MovingCollider, NarrowPhase},
    hierarchy::{BoundRule, BoundingVolume, NodeBounds, QuadTree, TopDownQuery},
    prelude::{
        ClothAttachments, ClothBody, ClothCollider, ClothGravity, ClothInertia, ClothLod,
        ClothLodLevel, ClothPaint, ClothSettings, ClothSkin, DrapePlugins, Pin, Pins,
    },
    solver::{
        Air, Bending, Control, PinMotion, Solver, Stretch, Substepping, Tethers, TickStep,
        methods::meshes,
    },
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

#[test]
fn a_step_does_not_allocate() {
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
        solver.set_bending(Bending::new(&surface, &stiff));
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
    sharp_colliders_do_not_allocate();
    a_mesh_does_not_allocate();
    air_does_not_allocate();
    neither_forces_nor_damping_allocate();
    what_is_attached_or_animated_allocates_nothing();
    what_is_pushed_allocates_nothing();
    characters_allocate_nothing_more();
    cloths_made_alike_share_all_but_their_particles();
}

/// A cloth that hangs against what has edges, which its triangles touch.
fn sharp_colliders_do_not_allocate() {
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
fn neither_forces_nor_damping_allocate() {
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

fn a_mesh_does_not_allocate() {
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
fn air_does_not_allocate() {
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
            ..Air::NONE
        };
        let mut ticks = |count: u32| {
            for _ in 0..count {
                solver.set_air(&surface, Some(air));
                solver.set_local_wind(&particles, |place| place + Vec3::Z);
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

/// An app on one thread, as each thread that is woken allocates, and without the propagation of transforms, which allocates as it likes.
fn app_on_one_thread<M>(plugins: impl Plugins<M>) -> App {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins)
        .add_plugins(plugins)
        .add_plugins(DrapePlugins::default())
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    let mut schedules = app.world_mut().resource_mut::<Schedules>();
    for (_, schedule) in schedules.iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
    app
}

/// Allocations in a hundred ticks, each after a change of the world, once there have been some.
fn in_ticks(mut app: App, change: impl Fn(&mut World, u32)) -> usize {
    let mut tick = |count: u32| {
        change(app.world_mut(), count);
        app.update();
    };
    (0..100).for_each(&mut tick);
    let region = Region::new(ALLOCATOR);
    (100..200).for_each(&mut tick);
    let change = region.change();
    change.allocations + change.reallocations
}

/// Allocations with a cloth whose attached pins move.
fn with_attachments(pins: usize, is_animated: bool, levels: &[ClothLodLevel]) -> usize {
    let mut app = app_on_one_thread(());
    let target = app.world_mut().spawn(Transform::default()).id();
    let attached = (0..pins).map(|pin| (Pin::Index(pin), target));
    let attached = ClothAttachments::new(attached);
    let settings = ClothSettings {
        tethers: true,
        ..Default::default()
    };
    let cloth = (Cloth::new(20, 20, 0.05), Pins::none(), attached, settings);
    let lod = ClothLod::at(ClothLodLevel::Full);
    let cloth = app.world_mut().spawn((cloth, lod)).id();
    in_ticks(app, |world, count| {
        let some = 0.01 * (count % 7) as f32;
        let mut place = world.get_mut::<Transform>(target).expect("a place");
        place.translation.x = some;
        if let Some(level) = levels.get(count as usize / 6 % levels.len().max(1)) {
            let mut lod = world.get_mut::<ClothLod>(cloth).expect("a level");
            lod.level = Some(*level);
        }
        if is_animated {
            // Up to six times the usual, in all directions of a plane.
            let gravity = Vec2::from_angle(some * 50.0) * (1.0 + 1000.0 * some);
            world.resource_mut::<ClothGravity>().0 = gravity.extend(0.0);
            let mut material = world.get_mut::<ClothMaterial>(cloth).expect("a material");
            material.damping = 0.01 + some;
            material.friction = 0.4 + some;
        }
    })
}

/// Allocations with a ball that is moved up and down on a taut cloth, which it presses on; the cloth pushes it back or not.
fn with_a_ball(is_body: bool) -> usize {
    let mut app = app_on_one_thread(());
    let edge = |row: u32, column: u32| row.is_multiple_of(19) || column.is_multiple_of(19);
    app.world_mut().spawn((
        Cloth::new(20, 20, 0.05).lying().centred(),
        Pins::filter(edge),
    ));
    let ball = (ClothCollider::ball(0.15), Transform::default());
    let ball = app.world_mut().spawn(ball).id();
    if is_body {
        let body = ClothBody::new(0.5, Vec3::splat(0.004));
        app.world_mut().entity_mut(ball).insert(body);
    }
    in_ticks(app, |world, count| {
        let mut place = world.get_mut::<Transform>(ball).expect("a place");
        place.translation.y = 0.15 - 0.005 * (count % 7) as f32;
    })
}

/// Allocations with a skinned cloth whose only bone moves, and its root.
fn with_a_character(follows: bool) -> usize {
    let mut app = app_on_one_thread((AssetPlugin::default(), MeshPlugin));
    app.init_asset::<SkinnedMeshInverseBindposes>();
    let sheet = meshes::irregular(1.0, 1.0, 0.05, 0.2);
    let count = sheet.positions.len();
    let positions: Vec<_> = sheet.positions.iter().map(Vec3::to_array).collect();
    let mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_indices(Indices::U32(sheet.triangles.as_flattened().to_vec()))
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_JOINT_INDEX,
        VertexAttributeValues::Uint16x4(vec![[0; 4]; count]),
    )
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_JOINT_WEIGHT,
        vec![[1.0, 0.0, 0.0, 0.0]; count],
    );
    let world = app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let mut poses = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    let inverse_bindposes = poses.add(vec![Mat4::IDENTITY]);
    let root = world.spawn(Transform::default()).id();
    let bone = world.spawn((Transform::default(), ChildOf(root))).id();
    let skin = SkinnedMesh {
        inverse_bindposes,
        joints: vec![bone],
    };
    let cloth = (
        Cloth::mesh(),
        Mesh3d(mesh),
        skin,
        Pins::new([Pin::Vertex(0)]),
    );
    let cloth = world.spawn((cloth, ChildOf(root))).id();
    if follows {
        let skin = ClothSkin::within(ClothPaint::at_rest(|place| 0.1 * place.x));
        world
            .entity_mut(cloth)
            .insert(skin.with_backstop(0.05, 1.0));
        world.entity_mut(root).insert(ClothInertia::share(0.3));
    }
    in_ticks(app, |world, count| {
        let some = (0.1 * count as f32).sin();
        for (entity, angle) in [(root, 0.2), (bone, 0.3)] {
            let mut place = world.get_mut::<Transform>(entity).expect("a place");
            place.rotation = Quat::from_rotation_z(angle * some);
        }
    })
}

/// Whether a cloth follows its skeleton, and is carried along, or does not.
fn characters_allocate_nothing_more() {
    let [without, with] = [false, true].map(with_a_character);
    println!("{with} of {without}");
    assert!(with <= without, "{with} of {without}");
}

/// Whether a ball pushes cloth alone or is pushed back.
fn what_is_pushed_allocates_nothing() {
    for is_body in [false, true] {
        let allocations = with_a_ball(is_body);
        assert_eq!(allocations, 0, "pushed back: {is_body}");
    }
}

/// Whether a cloth has one attached pin or two hundred, whether what tethers do not depend on is animated, and however its level of detail
/// changes.
fn what_is_attached_or_animated_allocates_nothing() {
    for (pins, is_animated) in [(1, false), (200, false), (1, true)] {
        let allocations = with_attachments(pins, is_animated, &[]);
        assert_eq!(allocations, 0, "{pins} pins, animated: {is_animated}");
    }
    let levels = [
        ClothLodLevel::Every(2),
        ClothLodLevel::Frozen,
        ClothLodLevel::Full,
    ];
    let allocations = with_attachments(1, false, &levels);
    assert_eq!(allocations, 0, "levels of detail");
}

/// Bytes that a cloth takes after some ticks, pinned at its upper edge, where others are made alike. Run with `--nocapture` it
/// prints them.
///
/// A particle has 32 bytes of state in blocks that may be a tenth empty, and as much again to see whether it rests; for tethers
/// 6 to 24, the more the less blocks have pins in common; where a list of springs is swept 32 more. Bending takes a dozen more
/// of a soft grid, and of a mesh 60 for what it solves; a motion of second order takes 24 for what it remembers, and threads on a
/// mesh 30 for what they have pulled with. That is 170 to 265 in all, and 16 kB for the cloth.
fn cloths_made_alike_share_all_but_their_particles() {
    let mesh = meshes::irregular(1.0, 1.0, 1.0 / 30.0, 0.3);
    let upper_edge = Pins::new([Pin::at_rest(|place| place.y > -1.0e-3)]);
    let of_mesh = Cloth::triangles(mesh.positions, mesh.triangles);
    for (name, cloth, pins, a_particle) in [
        ("grid", Cloth::new(31, 31, 1.0 / 30.0), Pins::default(), 170),
        ("mesh", of_mesh, upper_edge, 265),
    ] {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
        app.finish();
        app.cleanup();
        let mut spawn = |count: usize| {
            for _ in 0..count {
                app.world_mut().spawn((cloth.clone(), pins.clone()));
            }
            let region = Region::new(ALLOCATOR);
            (0..40).for_each(|_| app.update());
            let change = region.change();
            change.bytes_allocated as isize - change.bytes_deallocated as isize
                + change.bytes_reallocated
        };
        let first = spawn(1);
        let other = spawn(100) / 100;
        println!(
            "a {name} of 961 particles: {first} bytes, and {other} each of a hundred more: {:.0} a particle",
            other as f64 / 961.0
        );
        assert!(other < 961 * a_particle + 16_384, "{name}: {other}");
        assert!(first > other, "{name}: {first} of the first");
    }
}
