//! Colliders that force a cloth: what narrow threads would let through, and what is pulled out of a grip.

use bevy::{math::DVec3, prelude::*};
use bevy_drape::prelude::*;

use crate::support::*;

/// Where something is after so many seconds.
#[derive(Component)]
struct Path(Box<dyn Fn(f32) -> Transform + Send + Sync>);

fn along(path: impl Fn(f32) -> Transform + Send + Sync + 'static) -> (Transform, Path) {
    (path(0.0), Path(Box::new(path)))
}

/// Runs an app, in which everything follows its path.
fn run(app: &mut App, seconds: f32, mut each: impl FnMut(&mut App)) {
    for count in 1..=(seconds * 64.0) as u32 {
        let passed = count as f32 * TICK;
        let mut moving = app.world_mut().query::<(&Path, &mut Transform)>();
        for (path, mut transform) in moving.iter_mut(app.world_mut()) {
            *transform = path.0(passed);
        }
        tick(app, 1);
        each(app);
    }
}

/// Largest speed of a particle (m/s) and largest stretch of a cloth, in all ticks.
fn worst(app: &mut App, cloth: Entity, seconds: f32) -> [f32; 2] {
    let mut worst = [0.0_f32; 2];
    run(app, seconds, |app| {
        let particles = particles(app, cloth);
        for index in 0..particles.len() {
            let velocity = particles.velocity(index).expect("a velocity");
            worst[0] = worst[0].max(velocity.length());
        }
        worst[1] = worst[1].max(stats(app, cloth).stretch.structural);
    });
    worst
}

/// A sheet that lies, to be pulled by its first row.
fn pulled(
    app: &mut App,
    particles: u32,
    path: impl Fn(f32) -> Vec3 + Send + Sync + 'static,
) -> Entity {
    let flat = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let sheet = (
        Cloth::new(particles, particles, 0.05).centred(),
        Pins::new([Pin::Row(0)]),
        along(move |time| Transform::from_translation(path(time)).with_rotation(flat)),
    );
    app.world_mut().spawn(sheet).id()
}

/// Pulled out from between a table and a plate that presses it down, a sheet slides: without a spring that is stretched by more than a
/// few per cent, and without being thrown.
#[test]
fn what_is_pinched_slides_out() {
    for speed in [1.0, 3.0] {
        let mut app = app();
        let sheet = pulled(&mut app, 24, move |time| {
            Vec3::new(0.0, 0.31, speed * (time - 1.0).max(0.0))
        });
        app.world_mut().spawn((
            ClothCollider::cuboid(0.6, 0.3, 0.6),
            Transform::from_xyz(0.0, 0.145, 0.0),
        ));
        app.world_mut().spawn((
            ClothCollider::cuboid(0.4, 0.02, 0.4),
            along(|time| Transform::from_xyz(0.0, (0.6 - time).max(0.33), 0.0)),
        ));
        let [fastest, stretch] = worst(&mut app, sheet, 3.0);
        println!("{speed} m/s: {fastest} m/s, stretch {stretch}");
        assert!(stretch < 0.1, "{speed} m/s: stretch {stretch}");
        // Twice as fast as it falls from there and is pulled.
        assert!(
            fastest < 2.0 * (speed + 4.0 * GRAVITY.sqrt()),
            "{speed} m/s: {fastest} m/s"
        );
    }
}

/// A sheet pulled off a chair comes off, by boxes and by meshes. It is stretched most where it falls on the chair's edge.
#[test]
fn a_sheet_comes_off_a_chair() {
    let board = |size: Vec3, is_mesh: bool| {
        let corner = |index: u8| {
            let side = |bit: u8, half: f32| if index & bit > 0 { half } else { -half };
            let half = size / 2.0;
            Vec3::new(side(1, half.x), side(2, half.y), side(4, half.z))
        };
        match is_mesh {
            true => ClothCollider::convex_hull((0..8).map(corner).collect::<Vec<Vec3>>()),
            false => ClothCollider::cuboid(size.x, size.y, size.z),
        }
    };
    for is_mesh in [false, true] {
        let mut app = app();
        let parts = [
            (Vec3::new(0.5, 0.05, 0.5), Vec3::Y * 0.45),
            (Vec3::new(0.5, 0.5, 0.05), Vec3::new(0.0, 0.7, -0.25)),
        ];
        for (size, place) in parts {
            let part = (board(size, is_mesh), Transform::from_translation(place));
            app.world_mut().spawn(part);
        }
        app.world_mut()
            .spawn((ClothCollider::plane(), Transform::default()));
        let sheet = pulled(&mut app, 25, |time| {
            Vec3::new(0.0, 1.0, 0.05 + 3.0 * (time - 2.0).max(0.0))
        });
        let [fastest, stretch] = worst(&mut app, sheet, 4.0);
        println!("mesh {is_mesh}: {fastest} m/s, stretch {stretch}");
        assert!(
            stretch < 0.25 && fastest < 20.0,
            "{fastest} m/s, stretch {stretch}"
        );
        let last = particles(&app, sheet).len() as u32 / 25 - 1;
        // The chair's back is at −0.25 m.
        let place = position(&app, sheet, (last, 12));
        assert!(place.z > 0.3, "its end is still at {place}");
    }
}

/// Whether a point is below a sheet that lies in the plane z = 0 and is held by its border: an odd number of triangles is above
/// it.
fn is_below(point: DVec3, triangles: &[[DVec3; 3]]) -> bool {
    let above = triangles.iter().filter(|corners| {
        let [a, b, c] = corners.map(|corner| corner - point);
        let area = |a: DVec3, b: DVec3| a.x * b.y - a.y * b.x;
        let parts = [area(b, c), area(c, a), area(a, b)];
        let whole: f64 = parts.iter().sum();
        let is_over = whole != 0.0 && parts.iter().all(|part| part * whole >= 0.0);
        is_over && (parts[0] * a.z + parts[1] * b.z + parts[2] * c.z) / whole > 0.0
    });
    above.count() % 2 == 1
}

fn random(seed: &mut u64) -> f32 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 40) as f32 / (1_u32 << 24) as f32
}

/// A sheet of 32² particles, 0.1 m apart and held by its border: a grid, or a mesh of irregular triangles.
fn spawn_held(app: &mut App, seed: &mut u64, is_mesh: bool) -> Entity {
    const SIDE: u32 = 32;
    let is_border = |row: u32, column: u32| {
        [row, column]
            .iter()
            .any(|&index| index == 0 || index == SIDE - 1)
    };
    if !is_mesh {
        let sheet = Cloth::new(SIDE, SIDE, 0.1).centred();
        let sheet = (sheet, Pins::filter(is_border), Transform::default());
        return app.world_mut().spawn(sheet).id();
    }
    let half = 0.1 * (SIDE - 1) as f32 / 2.0;
    let mut corners = Vec::new();
    let mut triangles = Vec::new();
    for row in 0..SIDE {
        for column in 0..SIDE {
            let by = if is_border(row, column) { 0.0 } else { 0.04 };
            let off = Vec2::new(random(seed) - 0.5, random(seed) - 0.5) * by;
            let (x, y) = (0.1 * column as f32 - half, half - 0.1 * row as f32);
            corners.push(Vec3::new(x + off.x, y + off.y, 0.0));
            if row + 1 < SIDE && column + 1 < SIDE {
                let a = row * SIDE + column;
                let (b, c, d) = (a + 1, a + SIDE, a + SIDE + 1);
                triangles.extend(match random(seed) < 0.5 {
                    true => [[a, c, b], [b, c, d]],
                    false => [[a, c, d], [a, d, b]],
                });
            }
        }
    }
    let pins = Pins::new([Pin::at_rest(move |place| {
        place.abs().max_element() > half - 0.01
    })]);
    let sheet = (
        Cloth::triangles(corners, triangles),
        pins,
        Transform::default(),
    );
    app.world_mut().spawn(sheet).id()
}

/// Whether a random stick, 1 to 4 cm thick, gets through at 3 to 30 m/s: by any of five points along it, as a tick ends.
fn passes(seed: u64, is_spinning: bool) -> bool {
    let mut seed = seed.wrapping_mul(7_919).wrapping_add(17);
    for _ in 0..8 {
        random(&mut seed);
    }
    let seed = &mut seed;
    let mut between = |low: f32, high: f32| low + (high - low) * random(seed);
    let mut direction = || {
        let [x, y, z] = [(); 3].map(|()| between(-1.0, 1.0));
        Vec3::new(x, y, z).normalize_or(Vec3::X)
    };
    let (axis, spin, aside) = (direction(), direction(), direction());
    let size = Vec3::new(between(0.3, 0.8), between(0.01, 0.04), between(0.01, 0.04));
    let speed = between(3.0, 30.0);
    let turn = Quat::from_axis_angle(axis, between(0.0, 3.1));
    let spin = spin * if is_spinning { between(0.0, 20.0) } else { 0.0 };
    let way = (Vec3::NEG_Z + 0.5 * aside).normalize();
    let meets = Vec3::new(between(-0.5, 0.5), between(-0.5, 0.5), 0.0);
    let far = size.x / 2.0 + 0.3;
    let from = meets - way * (far + between(0.0, 1.0) * speed * TICK);
    let is_mesh = between(0.0, 1.0) < 0.5;
    let mut app = app();
    let sheet = spawn_held(&mut app, seed, is_mesh);
    let path = move |time: f32| {
        let time = time.min((far + 0.7) / speed);
        let rotation = Quat::from_scaled_axis(spin * time) * turn;
        Transform::from_translation(from + way * speed * time).with_rotation(rotation)
    };
    let stick = ClothCollider::cuboid(size.x, size.y, size.z);
    let stick = app.world_mut().spawn((stick, along(path))).id();
    tick(&mut app, 1);
    let surface = app.world().get::<Cloth>(sheet).expect("a cloth");
    let surface = surface.surface(Vec3::ONE).expect("a surface");
    let mut is_through = false;
    run(&mut app, ((far + 0.7) / speed).min(0.6), |app| {
        let frame = app.world().get::<ClothFrame>(sheet).expect("a frame");
        let places: Vec<DVec3> = (particles(app, sheet).positions())
            .map(|place| frame.to_world(place).as_dvec3())
            .collect();
        let corners = surface.triangles().iter();
        let triangles: Vec<[DVec3; 3]> = corners
            .map(|corners| corners.map(|corner| places[corner as usize]))
            .collect();
        let stick = app.world().get::<Transform>(stick).expect("a transform");
        is_through |= [-0.45_f32, -0.2, 0.0, 0.2, 0.45].iter().any(|part| {
            let point = stick.translation + stick.rotation * (Vec3::X * (part * size.x));
            // Not exactly below a thread.
            let point = point.as_dvec3() + DVec3::new(1.1e-5, 2.3e-5, 0.0);
            is_below(point, &triangles)
        });
    });
    is_through
}

/// Sticks that fit between the threads do not get through: of 1,000 none did when this was written. One in a hundred may, as each is a
/// fight of springs with edges.
#[test]
fn sticks_hardly_ever_pass() {
    let count = if is_long() { 500 } else { 30 };
    for is_spinning in [false, true] {
        let passing = (0..count).filter(|&seed| passes(seed, is_spinning));
        let passing: Vec<u64> = passing.collect();
        println!("{passing:?} of {count} pass, spinning {is_spinning}");
        assert!(
            passing.len() as u64 <= count / 100,
            "{passing:?} of {count}, spinning {is_spinning}"
        );
    }
}
