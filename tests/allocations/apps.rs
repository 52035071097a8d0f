//! Ticks of apps.

use bevy::{
    app::Plugins,
    asset::RenderAssetUsages,
    ecs::schedule::SingleThreadedExecutor,
    mesh::{
        Indices, MeshPlugin, PrimitiveTopology, VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    time::TimeUpdateStrategy,
};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles},
    prelude::{
        ClothAttachments, ClothBody, ClothCollider, ClothCreasing, ClothGrab, ClothGravity,
        ClothInertia, ClothLod, ClothLodLevel, ClothPaint, ClothSeam, ClothSelfCollision,
        ClothSettings, ClothSkin, ClothStats, ClothTears, DrapePlugins, Pin, Pins,
    },
};
use stats_alloc::Region;

use crate::{ALLOCATOR, meshes};

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

/// Allocations with a cloth that creases and whose attached pins move.
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
    let creases = ClothCreasing {
        yield_curvature: 0.5,
        hardening: 0.3,
    };
    let cloth = app.world_mut().spawn((cloth, creases, lod)).id();
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

/// Allocations with a box that sinks onto a cloth on a table or on the ground again and again, and is held, by a cloth that sleeps or not.
fn with_a_box_that_stands(is_table: bool, sleeps: bool) -> usize {
    let mut app = app_on_one_thread(());
    let (ground, height) = match is_table {
        true => (ClothCollider::cuboid(1.4, 0.2, 1.4), -0.1),
        false => (ClothCollider::plane(), 0.0),
    };
    app.world_mut()
        .spawn((ground, Transform::from_xyz(0.0, height, 0.0)));
    let cloth = Cloth::new(20, 20, 0.05).lying().centred();
    let settings = ClothSettings {
        particle_radius: 0.004,
        sleeps,
        ..default()
    };
    let place = Transform::from_xyz(0.0, 0.004, 0.0);
    app.world_mut()
        .spawn((cloth, Pins::none(), settings, place));
    let thing = (
        ClothCollider::cuboid(0.2, 0.1, 0.2),
        ClothBody::new(2.0, Vec3::splat(0.01)),
        Transform::from_xyz(0.0, 0.06, 0.0),
    );
    let thing = app.world_mut().spawn(thing).id();
    in_ticks(app, |world, _| {
        let mut place = world.get_mut::<Transform>(thing).expect("a place");
        // Without the ground it would be a metre below.
        assert!(place.translation.y > 0.05, "{}", place.translation);
        place.translation.y -= 0.005;
    })
}

/// The use of a skinned sheet.
#[derive(Clone, Copy, PartialEq)]
enum Skinned {
    Cloth,
    /// It follows its pose, and is carried along by its root.
    Followed,
    /// It is a collider, below a cloth.
    Collider,
}

/// Allocations with a skinned sheet whose only bone moves, and its root.
fn with_a_character(skinned: Skinned) -> usize {
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
    let sheet = world.spawn((Mesh3d(mesh), skin, ChildOf(root))).id();
    match skinned {
        Skinned::Collider => {
            world.entity_mut(sheet).insert(ClothCollider::mesh());
            // Drawn against it.
            world.insert_resource(ClothGravity(Vec3::NEG_Z * 9.81));
            let place = Transform::from_xyz(0.0, 0.0, 0.02);
            world.spawn((Cloth::new(20, 20, 0.05), Pins::none(), place));
        }
        Skinned::Cloth | Skinned::Followed => {
            let cloth = (Cloth::mesh(), Pins::new([Pin::Vertex(0)]));
            world.entity_mut(sheet).insert(cloth);
        }
    }
    if skinned == Skinned::Followed {
        let skin = ClothSkin::within(ClothPaint::at_rest(|place| 0.1 * place.x));
        world
            .entity_mut(sheet)
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

/// Whether a cloth follows its skeleton, and is carried along, or does not; and a skinned collider no more.
pub fn characters_allocate_nothing_more() {
    let all = [Skinned::Cloth, Skinned::Followed, Skinned::Collider];
    let [without, with, collider] = all.map(with_a_character);
    println!("{with} of {without}");
    assert!(with <= without, "{with} of {without}");
    assert!(collider <= without, "{collider} with a skinned collider");
}

/// Whether a ball pushes cloth alone or is pushed back.
pub fn what_is_pushed_allocates_nothing() {
    for is_body in [false, true] {
        let allocations = with_a_ball(is_body);
        assert_eq!(allocations, 0, "pushed back: {is_body}");
    }
    for (is_table, sleeps) in [(true, true), (true, false), (false, false)] {
        let allocations = with_a_box_that_stands(is_table, sleeps);
        let what = format!("a box stands on a table: {is_table}, sleeps: {sleeps}");
        assert_eq!(allocations, 0, "{what}");
    }
}

/// A hand that pulls at a hanging sheet, farther than it reaches.
pub fn a_hand_allocates_nothing() {
    let mut app = app_on_one_thread(());
    let cloth = app.world_mut().spawn(Cloth::new(20, 20, 0.05)).id();
    let grab = ClothGrab {
        cloth,
        particle: 210,
        ..default()
    };
    let hand = app.world_mut().spawn(grab).id();
    let allocations = in_ticks(app, |world, count| {
        let mut grab = world.get_mut::<ClothGrab>(hand).expect("a hand");
        grab.target = Vec3::new(0.5, -0.5, 0.3 * (count % 7) as f32);
    });
    assert_eq!(allocations, 0);
}

/// A sheet that lies folded on the floor, awake.
pub fn what_touches_itself_allocates_nothing() {
    let mut app = app_on_one_thread(());
    app.world_mut().spawn(ClothCollider::plane());
    let sheet = (
        Cloth::new(16, 16, 0.05).lying().centred(),
        Pins::none(),
        ClothSelfCollision::default(),
        ClothSettings {
            sleeps: false,
            ..default()
        },
        Transform::from_xyz(0.0, 0.01, 0.0),
    );
    let sheet = app.world_mut().spawn(sheet).id();
    app.update();
    let mut particles = app.world_mut().get_mut::<ClothParticles>(sheet);
    let particles = particles.as_mut().expect("it is built");
    for index in 0..particles.len() {
        let at = particles.position(index).expect("it exists");
        let folded = Vec3::new(
            at.x,
            at.y + if at.z > 0.0 { 0.02 } else { 0.0 },
            -at.z.abs(),
        );
        particles.set_position(index, folded).expect("finite");
    }
    assert_eq!(in_ticks(app, |_, _| {}), 0);
}

/// Two sheets that hang before each other, so near that they are moved together; sewn along their lower edges, or not. The first one's
/// corner is moved.
pub fn what_moves_together_allocates_nothing() {
    for is_sewn in [false, true] {
        let mut app = app_on_one_thread(());
        let sheets = [0.0, 0.012].map(|z| {
            let settings = ClothSettings {
                sleeps: false,
                ..default()
            };
            let sheet = (
                Cloth::new(16, 16, 0.05),
                ClothSelfCollision::default(),
                settings,
                Transform::from_xyz(0.0, 0.0, z),
            );
            app.world_mut().spawn(sheet).id()
        });
        if is_sewn {
            let [first, second] = sheets;
            let seam = ClothSeam::new((first, Pin::Row(15)), (second, Pin::Row(15)));
            app.world_mut().spawn(seam);
        }
        let swing = |world: &mut World, count: u32| {
            let mut place = world.get_mut::<Transform>(sheets[0]).expect("a place");
            place.translation.z = 0.002 * (0.3 * count as f32).sin();
        };
        // Until the lists are as long as they will be.
        for count in 0..400 {
            swing(app.world_mut(), count);
            app.update();
        }
        let allocations = in_ticks(app, swing);
        assert_eq!(allocations, 0, "sewn: {is_sewn}");
    }
}

/// A banner cut in two: one piece swings from its pole, the other sleeps on the floor.
pub fn pieces_allocate_nothing() {
    const SIDE: u32 = 12;
    let mut app = app_on_one_thread(());
    let floor = Transform::from_xyz(0.0, -1.2, 0.0);
    app.world_mut().spawn((ClothCollider::plane(), floor));
    let pole = app.world_mut().spawn(Transform::default()).id();
    let mut tears = ClothTears::default();
    tears.tear_all((1..SIDE).map(|column| [5 * SIDE + column - 1, 5 * SIDE + column]));
    let banner = (
        Cloth::new(SIDE, SIDE, 0.1),
        Pins::none(),
        ClothAttachments::new([(Pin::Row(0), pole)]),
        tears,
    );
    let banner = app.world_mut().spawn(banner).id();
    let swing = |world: &mut World, count: u32| {
        let mut pole = world.get_mut::<Transform>(pole).expect("a place");
        pole.translation.z = 0.1 * (0.1 * count as f32).sin();
    };
    // Twelve times to and fro, so that it goes on as it began.
    for count in 0..754 {
        swing(app.world_mut(), count);
        app.update();
    }
    let swing_on = |world: &mut World, count: u32| {
        let stats = world.get::<ClothStats>(banner).expect("a cloth");
        assert!(stats.sleeping_particles > 0 && !stats.is_asleep);
        swing(world, count);
    };
    assert_eq!(in_ticks(app, swing_on), 0);
}

/// Whether a cloth has one attached pin or two hundred, whether what tethers do not depend on is animated, and however its level of detail
/// changes.
pub fn what_is_attached_or_animated_allocates_nothing() {
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
pub fn cloths_made_alike_share_all_but_their_particles() {
    // Enough to show what each takes besides what they share.
    const COUNT: usize = 30;
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
        let other = spawn(COUNT) / COUNT as isize;
        println!(
            "a {name} of 961 particles: {first} bytes, and {other} each of {COUNT} more: {:.0} a particle",
            other as f64 / 961.0
        );
        assert!(other < 961 * a_particle + 16_384, "{name}: {other}");
        assert!(first > other, "{name}: {first} of the first");
    }
}
