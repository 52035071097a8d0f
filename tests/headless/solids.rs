//! Cloth on shapes with edges: nothing of them shows, from neither side, however thin.

use std::f32::consts::FRAC_PI_2;

use bevy::{
    asset::RenderAssetUsages,
    math::DVec3,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_drape::prelude::*;

use crate::support::*;

/// Lies flat at a height, its middle above the origin.
fn lying(cloth: Cloth, height: f32) -> impl Bundle {
    let place = Transform::from_xyz(-cloth.width() / 2.0, height, -cloth.height() / 2.0);
    let place = place.with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
    (cloth, Pins::none(), place)
}

/// The cloth's triangles in the world.
fn triangles(app: &App, cloth: Entity) -> Vec<[DVec3; 3]> {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let recipe = app.world().get::<Cloth>(cloth).expect("a cloth");
    let surface = recipe.surface(Vec3::ONE).expect("a grid");
    let places: Vec<DVec3> = particles(app, cloth)
        .positions()
        .map(|position| frame.to_world(position).as_dvec3())
        .collect();
    let corners = surface.triangles().iter();
    corners
        .map(|corners| corners.map(|corner| places[corner as usize]))
        .collect()
}

/// How far the nearer end of the deepest edge is through a triangle of the cloth (m), in f64.
fn shows_through(app: &App, cloth: Entity, edges: &[[Vec3; 2]]) -> f64 {
    let mut deepest = 0.0_f64;
    for [a, b, c] in triangles(app, cloth) {
        let normal = (b - a).cross(c - a).normalize();
        for ends in edges {
            let [from, to] = ends.map(Vec3::as_dvec3);
            let (before, after) = (normal.dot(from - a), normal.dot(to - a));
            if before * after >= 0.0 {
                continue;
            }
            let point = from.lerp(to, before / (before - after));
            let is_within = [(a, b), (b, c), (c, a)]
                .iter()
                .all(|&(first, second)| (second - first).cross(point - first).dot(normal) > 0.0);
            if is_within {
                deepest = deepest.max(before.abs().min(after.abs()));
            }
        }
    }
    deepest
}

/// The edges of a box of so many metres in a place.
fn box_edges(size: Vec3, place: Transform) -> Vec<[Vec3; 2]> {
    let corner = |index: usize| {
        let sign = |bit: usize| if index & bit == 0 { -0.5 } else { 0.5 };
        place.transform_point(Vec3::new(sign(1), sign(2), sign(4)) * size)
    };
    let pairs = (0..8).flat_map(|from| [1, 2, 4].map(|bit| [from, from | bit]));
    let pairs = pairs.filter(|[from, to]| from != to);
    pairs.map(|ends| ends.map(corner)).collect()
}

/// The triangles of a box, for those who make it a mesh.
fn box_mesh(size: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corners = (0..8_u8).map(|index| {
        let sign = |bit: u8| if index & bit == 0 { -0.5 } else { 0.5 };
        Vec3::new(sign(1), sign(2), sign(4)) * size
    });
    let faces = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let triangles = faces.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).concat();
    (corners.collect(), triangles)
}

/// A box by each of the ways to make one.
fn boxes(size: Vec3) -> [ClothCollider; 4] {
    let (corners, triangles) = box_mesh(size);
    let half = size / 2.0;
    let part = Isometry3d::from_xyz(half.x / 2.0, 0.0, 0.0);
    let other = Isometry3d::from_xyz(-half.x / 2.0, 0.0, 0.0);
    let part_of = ClothCollider::cuboid(half.x, size.y, size.z);
    [
        ClothCollider::cuboid(size.x, size.y, size.z),
        ClothCollider::convex_hull(corners.clone()),
        ClothCollider::trimesh(corners, triangles),
        ClothCollider::compound([(part, part_of.clone()), (other, part_of)]),
    ]
}

/// Cloth of 0.1 m between particles falls on a box, turned or not: in no tick does an edge or a corner of the box go through any
/// of its triangles, by more than rounding.
#[test]
fn a_box_never_shows_through() {
    let size = Vec3::new(0.5, 0.4, 0.6);
    let turned = Quat::from_axis_angle(Vec3::new(1.0, 0.5, -0.7).normalize(), 0.9);
    for rotation in [Quat::IDENTITY, turned] {
        for collider in boxes(size) {
            let mut app = app();
            let cloth = app
                .world_mut()
                .spawn(lying(Cloth::new(16, 16, 0.1), 0.5))
                .id();
            let place = Transform::from_xyz(0.03, 0.0, 0.02).with_rotation(rotation);
            app.world_mut().spawn((collider.clone(), place));
            let edges = box_edges(size, place);
            let mut deepest = 0.0_f64;
            for _ in 0..128 {
                tick(&mut app, 1);
                deepest = deepest.max(shows_through(&app, cloth, &edges));
            }
            assert!(deepest < 1.0e-4, "{collider:?}: {deepest} m");
            let stats = app.world().get::<ClothStats>(cloth).expect("figures");
            assert_eq!((stats.colliders_near, stats.by_triangles), (1, 1));
        }
    }
}

/// A wall of half a spacing stands between two rows of particles: cloth that falls on it hangs over it, and none of its edges show.
#[test]
fn a_wall_thinner_than_a_spacing_holds_cloth() {
    let size = Vec3::new(1.2, 0.6, 0.05);
    for collider in boxes(size) {
        let mut app = app();
        let cloth = app
            .world_mut()
            .spawn(lying(Cloth::new(16, 16, 0.1), 0.6))
            .id();
        app.world_mut()
            .spawn((collider.clone(), Transform::IDENTITY));
        let edges = box_edges(size, Transform::IDENTITY);
        let mut deepest = 0.0_f64;
        for _ in 0..128 {
            tick(&mut app, 1);
            deepest = deepest.max(shows_through(&app, cloth, &edges));
        }
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        let heights = particles(&app, cloth)
            .positions()
            .map(|position| frame.to_world(position).y);
        let highest = heights.fold(f32::MIN, f32::max);
        assert!(
            highest > 0.25,
            "{collider:?}: the highest is at {highest} m"
        );
        assert!(deepest < 1.0e-4, "{collider:?}: {deepest} m");
    }
}

/// Random walls of 1 to 8 cm, cloth of 0.1 m between particles: their edges show in few ticks, and then by less than half of the spacing.
#[test]
fn thin_walls_hardly_show() {
    let count = if is_long() { 200 } else { 12 };
    let mut seed = 7_u64;
    let mut between = |low: f32, high: f32| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (seed >> 40) as f32 / (1_u32 << 24) as f32
    };
    let (mut shown, mut ticks) = (0, 0);
    for _ in 0..count {
        let size = Vec3::new(between(0.6, 1.6), between(0.2, 0.9), between(0.01, 0.08));
        let turned =
            Quat::from_rotation_y(between(0.0, 3.1)) * Quat::from_rotation_x(between(-0.5, 0.5));
        let place =
            Transform::from_xyz(between(-0.3, 0.3), 0.0, between(-0.3, 0.3)).with_rotation(turned);
        let mut app = app();
        let cloth = lying(Cloth::new(16, 16, 0.1), size.y / 2.0 + 0.4);
        let cloth = app.world_mut().spawn(cloth).id();
        let wall = ClothCollider::cuboid(size.x, size.y, size.z);
        app.world_mut().spawn((wall, place));
        let edges = box_edges(size, place);
        for tick_of in 0..128 {
            tick(&mut app, 1);
            let depth = shows_through(&app, cloth, &edges);
            let shows = depth > 1.0e-4;
            if shows {
                println!("{size} in tick {tick_of}: {depth} m");
            }
            assert!(depth < 0.05, "{size} in tick {tick_of}: {depth} m");
            shown += i32::from(shows);
            ticks += 1;
        }
    }
    println!("{shown} of {ticks} ticks");
    assert!(shown * 200 <= ticks, "{shown} of {ticks} ticks");
}

/// A sheet of two triangles, 2 m wide, goes through a falling cloth at 1 to 60 m/s, or the cloth's triangles would: it takes it
/// along, from below and from above.
#[test]
fn nothing_passes_a_fast_sheet() {
    for speed in [1.0_f32, 10.0, 60.0, -10.0, -60.0] {
        let mut app = app();
        app.insert_resource(ClothGravity(Vec3::ZERO));
        let cloth = app
            .world_mut()
            .spawn(lying(Cloth::new(11, 11, 0.1), 0.0))
            .id();
        let corners = [
            Vec3::new(-2.0, 0.0, -2.0),
            Vec3::new(2.0, 0.0, -2.0),
            Vec3::new(2.0, 0.0, 2.0),
            Vec3::new(-2.0, 0.0, 2.0),
        ];
        let sheet = ClothCollider::trimesh(corners, [[0, 1, 2], [0, 2, 3]]);
        let ticks = (1.0 / (speed.abs() * TICK)).ceil() as i32 + 3;
        // In its third tick it passes where the cloth is, or a little later.
        let at = |tick: i32| speed * TICK * (tick as f32 - 2.4) - speed.signum() * 0.1;
        let place = Transform::from_xyz(0.0, at(0), 0.0);
        let sheet = app.world_mut().spawn((sheet, place)).id();
        for step in 1..=ticks {
            change::<Transform>(&mut app, sheet, |place| place.translation.y = at(step));
            tick(&mut app, 1);
        }
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        for position in particles(&app, cloth).positions() {
            let ahead = (frame.to_world(position).y - at(ticks)) * speed.signum();
            assert!(ahead > 0.0, "{speed} m/s: {ahead} m");
        }
    }
}

/// Cloth that falls on an open bowl of a mesh lies in it, and cloth below it stays below.
#[test]
fn an_open_mesh_is_touched_from_both_sides() {
    let (above, below) = (0.3, -0.3);
    for (height, gravity) in [(above, Vec3::NEG_Y * GRAVITY), (below, Vec3::Y * GRAVITY)] {
        let mut app = app();
        app.insert_resource(ClothGravity(gravity));
        let cloth = app
            .world_mut()
            .spawn(lying(Cloth::new(11, 11, 0.08), height))
            .id();
        let sheet = bowl(0.4);
        app.world_mut().spawn((sheet, Transform::IDENTITY));
        tick(&mut app, 128);
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        let mut farthest = 0.0_f32;
        for position in particles(&app, cloth).positions() {
            let place = frame.to_world(position);
            let surface = 0.4 * (place.x * place.x + place.z * place.z);
            let off = (place.y - surface) * height.signum();
            assert!(off > -0.005, "{place} is {off} m off");
            farthest = farthest.max(off);
        }
        println!("{height} m: {farthest} m off");
        // A sheet of 0.8 m that stays flat on the rim of the part below it is 0.4 (0.4² + 0.4²) m off in its middle, which is what
        // lies deepest; a particle's radius comes on top.
        assert!(farthest < 0.128 + 0.01, "{farthest} m off");
    }
}

/// y = k (x² + z²) within 1 m.
fn bowl(k: f32) -> ClothCollider {
    let count = 25_u32;
    let vertices: Vec<Vec3> = (0..count * count)
        .map(|index| {
            let along = |cell: u32| cell as f32 / (count - 1) as f32 * 2.0 - 1.0;
            let (x, z) = (along(index % count), along(index / count));
            Vec3::new(x, k * (x * x + z * z), z)
        })
        .collect();
    let cells =
        (0..count - 1).flat_map(|row| (0..count - 1).map(move |column| row * count + column));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|first| {
            let below = first + count;
            [[first, below, first + 1], [first + 1, below, below + 1]]
        })
        .collect();
    ClothCollider::trimesh(vertices, triangles)
}

fn mesh_of(positions: &[Vec3], triangles: &[[u32; 3]]) -> Mesh {
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_POSITION,
        positions.iter().map(Vec3::to_array).collect::<Vec<_>>(),
    )
    .with_inserted_indices(Indices::U32(triangles.concat()))
}

/// A collider of a mesh waits for its asset, is that mesh, and changes with it; what is wrong with it is told.
#[test]
fn a_mesh_is_a_collider() {
    for (collider, is_hull) in [
        (ClothCollider::mesh(), false),
        (ClothCollider::mesh_hull(), true),
    ] {
        let mut app = app_that_draws(FixedUpdate);
        let handle = app
            .world_mut()
            .resource_mut::<Assets<Mesh>>()
            .reserve_handle();
        let cloth = app
            .world_mut()
            .spawn(lying(Cloth::new(16, 16, 0.1), 0.4))
            .id();
        let entity = (collider, Mesh3d(handle.clone()), Transform::IDENTITY);
        let entity = app.world_mut().spawn(entity).id();
        tick(&mut app, 2);
        let fault = app.world().get::<ClothFault>(entity).expect("a fault");
        assert_eq!(fault.error, MeshError::NotLoaded.into());
        // A box whose faces have vertices of their own, as those of Bevy have.
        let size = Vec3::new(0.6, 0.4, 0.6);
        let mesh = Mesh::from(Cuboid::from_size(size));
        let inserted = app
            .world_mut()
            .resource_mut::<Assets<Mesh>>()
            .insert(handle.id(), mesh);
        assert!(inserted.is_ok());
        let edges = box_edges(size, Transform::IDENTITY);
        for _ in 0..64 {
            tick(&mut app, 1);
            assert!(shows_through(&app, cloth, &edges) < 1.0e-4);
        }
        assert!(app.world().get::<ClothFault>(entity).is_none());
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        assert!(contacts.with(entity).is_some());
        // Another mesh in its place: a square in one plane, which is no hull.
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
        let flat = mesh_of(&square, &[[0, 1, 2], [0, 2, 3]]);
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        assert!(meshes.insert(handle.id(), flat).is_ok());
        tick(&mut app, 2);
        let fault = app
            .world()
            .get::<ClothFault>(entity)
            .map(|fault| fault.error.clone());
        let flat = ClothError::Shape(ShapeError::FlatHull { points: 4 });
        assert_eq!(fault, is_hull.then_some(flat));
    }
}

/// What is wrong with a shape is told once, and mending it brings it back.
#[test]
fn bad_shapes_are_left_out_until_they_are_mended() {
    let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::X * 3.0];
    for (bad, part) in [
        (ClothCollider::convex_hull(line), "hull"),
        (ClothCollider::trimesh(line, [[0, 1, 2]]), "area"),
        (
            ClothCollider::trimesh([Vec3::NAN; 3], [[0, 1, 2]]),
            "vertex 0",
        ),
        (
            ClothCollider::heightfield([0.0, 1.0], 1, Vec3::ONE),
            "height field",
        ),
        (ClothCollider::cylinder(1.0, f32::NAN), "cylinder"),
        (ClothCollider::cone(-1.0, 1.0), "cone"),
        (ClothCollider::compound([]), "compound"),
    ] {
        let mut app = app();
        let cloth = app
            .world_mut()
            .spawn(lying(Cloth::new(8, 8, 0.1), 0.0))
            .id();
        let entity = app.world_mut().spawn((bad, Transform::IDENTITY)).id();
        tick(&mut app, 3);
        let fault = app.world().get::<ClothFault>(entity).expect("a fault");
        assert!(fault.error.to_string().contains(part), "{fault:?}");
        app.world_mut()
            .entity_mut(entity)
            .insert(ClothCollider::cylinder(0.3, 0.2));
        tick(&mut app, 3);
        assert!(app.world().get::<ClothFault>(entity).is_none(), "{part}");
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        assert!(contacts.with(entity).is_some(), "{part}");
    }
}

/// How far a line between two points is above the cloth (m), at most, in f64.
fn above(app: &App, cloth: Entity, [from, to]: [Vec3; 2]) -> f64 {
    let mut highest = f64::MIN;
    for [a, b, c] in triangles(app, cloth) {
        let normal = (b - a).cross(c - a);
        for step in 0..=200 {
            let point = from.lerp(to, step as f32 / 200.0).as_dvec3();
            let below = point - DVec3::Y * normal.dot(point - a) / normal.y;
            let is_within = [(a, b), (b, c), (c, a)]
                .iter()
                .all(|&(first, second)| (second - first).cross(below - first).dot(normal) > 0.0);
            if is_within {
                highest = highest.max(point.y - below.y);
            }
        }
    }
    highest
}

/// A ridge is blunter than a box's edge: triangles may come nearer to it, but none lets it through, while the cloth falls on it and
/// when it rests there. Whichever way it is turned.
#[test]
fn blunt_ridges_do_not_show() {
    for (number, degrees) in [6.0_f32, 11.0, 17.0, 24.0, 30.0, 40.0]
        .into_iter()
        .enumerate()
    {
        let low = -0.6 * degrees.to_radians().tan();
        let heights = [low, 0.0, low].repeat(3);
        let ridge = [Vec3::NEG_Z * 0.4, Vec3::Z * 0.4];
        let turned = Transform::from_rotation(Quat::from_rotation_y(0.7 * number as f32));
        let mut app = app();
        let sheet = Cloth::new(24, 24, 0.05);
        let cloth = app.world_mut().spawn(lying(sheet, 0.1)).id();
        app.world_mut().spawn((
            ClothCollider::heightfield(heights, 3, Vec3::new(1.2, 1.0, 1.2)),
            turned,
        ));
        let line = ridge.map(|end| turned.transform_point(end));
        let mut highest = f64::MIN;
        for _ in 0..64 {
            tick(&mut app, 1);
            highest = highest.max(above(&app, cloth, line));
        }
        assert!(highest < 1.0e-4, "{degrees}°: {highest} m");
        assert!(highest > -0.012, "{degrees}°: it lies on it, {highest} m");
    }
}
