//! Bodies that stand on cloth which lies on something.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{push_back::*, support::*};

/// Radius of the particles (m).
const THICK: f32 = 0.004;

/// How far above what the cloth lies on a body stands (m): by 2.1 radii of the particles.
const ABOVE: f32 = 2.1 * THICK;

/// A cloth of a friction that lies on what is below it, at a pose.
pub fn spawn_cloth(app: &mut App, pose: Transform, friction: f32, pins: Pins) -> Entity {
    let cloth = (
        Cloth::new(31, 31, 0.04).lying().centred(),
        pins,
        ClothMaterial {
            friction,
            ..ClothMaterial::COTTON
        },
        ClothSettings {
            particle_radius: THICK,
            ..default()
        },
        pose * Transform::from_xyz(0.0, THICK, 0.0),
    );
    app.world_mut().spawn(cloth).id()
}

/// What a test puts on a cloth: its collider, the height of its middle above its foot (m), and its mass.
pub type Thing = (ClothCollider, f32, ClothBody);

/// A thing whose foot is on a cloth at a place of the pose.
pub fn spawn_on(app: &mut App, pose: Transform, (collider, height, body): Thing, x: f32) -> Entity {
    let thing = (
        collider,
        body,
        Body {
            gravity: GRAVITY,
            ..default()
        },
        pose * Transform::from_xyz(x, height + ABOVE, 0.0),
    );
    app.world_mut().spawn(thing).id()
}

/// A block of a mass (kg) and a size (m).
pub fn block(mass: f32, size: Vec3) -> Thing {
    let of = |a: f32, b: f32| mass * (a * a + b * b) / 12.0;
    let inertia = Vec3::new(of(size.y, size.z), of(size.z, size.x), of(size.x, size.y));
    let collider = ClothCollider::cuboid(size.x, size.y, size.z);
    (collider, size.y / 2.0, ClothBody::new(mass, inertia))
}

/// A cup of a mass (kg), a radius and a height (m): a cylinder.
pub fn cup(mass: f32, radius: f32, height: f32) -> Thing {
    let across = mass * (3.0 * radius * radius + height * height) / 12.0;
    let inertia = Vec3::new(across, mass * radius * radius / 2.0, across);
    let collider = ClothCollider::cylinder(radius, height);
    (collider, height / 2.0, ClothBody::new(mass, inertia))
}

/// How much a thing leans from an axis (degrees).
fn lean(app: &App, thing: Entity, up: Vec3) -> f32 {
    let place = app.world().get::<Transform>(thing).expect("a transform");
    place.up().angle_between(up).to_degrees()
}

/// How far a block has come down a slope of an angle, on cloth that is held above, after each of 48 ticks (m).
fn slide(angle: f32, friction: f32, mass: f32) -> Vec<f32> {
    let mut app = app_with_bodies();
    // Down is along the pose's x.
    let pose = Transform::from_rotation(Quat::from_rotation_z(-angle));
    app.world_mut().spawn((ClothCollider::plane(), pose));
    spawn_cloth(&mut app, pose, friction, Pins::new([Pin::Column(0)]));
    let thing = block(mass, Vec3::new(0.16, 0.06, 0.16));
    let block = spawn_on(&mut app, pose, thing, -0.3);
    let down = pose.rotation * Vec3::X;
    let from = place(&app, block).dot(down);
    let after = |app: &mut App| {
        tick(app, 1);
        place(app, block).dot(down) - from
    };
    (0..48).map(|_| after(&mut app)).collect()
}

/// A block on cloth on a slope holds below the angle of friction, once the cloth is taut, and slides above it by
/// g (sin α − μ cos α), within 5 %: the cloth below gives a little.
#[test]
fn a_block_slides_from_the_angle_of_friction_on() {
    for mass in [0.1, 1.0, 10.0] {
        for friction in [0.3_f32, 0.6] {
            for part in [0.5, 0.95, 1.2, 2.0] {
                let angle = (part * friction).atan();
                let way = slide(angle, friction, mass);
                // The means of two ticks in the middle and at the end of the time, as either lies between two speeds.
                let speed = (way[47] - way[15]) / (32.0 * TICK);
                let pull = GRAVITY * (angle.sin() - friction * angle.cos());
                let expected = pull.max(0.0) * TICK * 32.5;
                println!("{mass} kg, μ {friction}, {part} of it: {speed} m/s of {expected}");
                let off = (speed - expected).abs();
                assert!(
                    off < 0.05 * expected + 1.0e-3 && (part > 1.0 || way[47] < 0.01),
                    "{mass} kg, μ {friction}, {part} of it: {speed} m/s of {expected}, {} m",
                    way[47]
                );
            }
        }
    }
}

/// Pulled from under a cup, a cloth gives it no more than friction can in that time, μ g t² / 2 and a tenth, and what cloth beside a
/// light cup gives it in the jerk; without friction nothing. It takes a cup along where it is slow. The cup stays upright.
#[test]
fn a_cup_stays_when_its_cloth_is_pulled() {
    for (speed, friction) in [(4.0, 0.0), (4.0, 0.3), (0.3, 0.0), (0.3, 0.3)] {
        for mass in [0.1, 0.3, 2.0] {
            let mut app = app_with_bodies();
            // The cloth ends with the table where it is not pulled: a hem that hangs there would whip over the table.
            app.world_mut().spawn((
                ClothCollider::cuboid(1.2, 0.04, 1.4),
                Transform::from_xyz(-0.1, -0.02, 0.0),
            ));
            let pose = Transform::default();
            let cloth = spawn_cloth(&mut app, pose, friction, Pins::new([Pin::Column(30)]));
            let cup = spawn_on(&mut app, pose, cup(mass, 0.04, 0.1), -0.2);
            tick(&mut app, 32);
            let start = place(&app, cup);
            // Until the cloth's end, 0.4 m from the cup's middle, is below it.
            let ticks = (0.36 / speed / TICK) as u32;
            let mut moved = 0.0;
            for count in 1..=ticks.min(64) {
                change::<Transform>(&mut app, cloth, |place| {
                    place.translation.x += speed * TICK;
                });
                tick(&mut app, 1);
                moved = place(&app, cup).x - start.x;
                let time = count as f32 * TICK;
                // Velocity changes as a tick begins.
                let most = GRAVITY * friction * time * (time + TICK) / 2.0;
                let most = most.min(speed * time);
                // The jerk may send the cloth back for a tick.
                let least = -GRAVITY * friction * TICK * TICK;
                assert!(
                    moved < 1.1 * most + 5.0e-4 && moved > least - 1.0e-4,
                    "{speed} m/s, μ {friction}, {mass} kg, {time} s: {moved} m of {most}"
                );
                let leans = lean(&app, cup, Vec3::Y);
                assert!(leans < 1.0, "{speed} m/s, {mass} kg, {time} s: {leans}°");
            }
            println!("{speed} m/s, μ {friction}, {mass} kg: {moved} m");
            // It is taken along but for the time that it takes to get as fast, and what the cloth gives.
            if speed < 1.0 && friction > 0.0 {
                assert!(
                    moved > 0.9 * (speed - 0.05),
                    "{mass} kg: {moved} m in a second"
                );
            }
        }
    }
}

/// A ball that slides on a cloth on the ground begins to roll, by friction alone: it keeps 5/7 of its speed. It stays as high
/// as it was.
#[test]
fn a_ball_rolls_on_a_tablecloth() {
    for mass in [0.1, 5.0] {
        let mut app = app_with_bodies();
        app.world_mut().spawn(ClothCollider::plane());
        let pose = Transform::default();
        spawn_cloth(&mut app, pose, 0.5, Pins::new([Pin::Column(0)]));
        let (radius, speed) = (0.08, 1.4);
        let ball = (
            ClothCollider::ball(radius),
            radius,
            ClothBody::ball(mass, radius),
        );
        let ball = spawn_on(&mut app, pose, ball, -0.4);
        change::<Body>(&mut app, ball, |body| body.velocity.x = speed);
        for count in 0..40 {
            tick(&mut app, 1);
            let high = place(&app, ball).y - radius - ABOVE;
            // In the first tick the cloth is not there yet, and the ball begins to fall.
            assert!(
                count < 8 || high.abs() < 5.0e-4,
                "{mass} kg, tick {count}: {high} m too high"
            );
        }
        let (is, rolling) = (velocity(&app, ball).x, speed * 5.0 / 7.0);
        println!("{mass} kg: {is} m/s of {rolling}");
        assert!(
            (is / rolling - 1.0).abs() < 0.03,
            "{mass} kg: {is} m/s of {rolling}"
        );
    }
}

/// Random blocks slide to a stop on level ground, grids and meshes, as μ g says: within 5 %, since the cloth below gives a little.
#[test]
fn random_blocks_slide_to_a_stop() {
    for seed in 0..if is_long() { 60 } else { 6 } {
        let mut state = seed * 104_729 + 11;
        let mut random = |low: f32, high: f32| low + (high - low) * next(&mut state);
        let (friction, mass) = (random(0.2, 0.7), 10.0_f32.powf(random(-1.0, 1.0)));
        let size = Vec3::new(random(0.1, 0.2), random(0.02, 0.05), random(0.1, 0.2));
        let turn = Quat::from_rotation_y(random(0.0, std::f32::consts::TAU));
        let pose = Transform::from_rotation(turn);
        let mut app = app_with_bodies();
        app.world_mut().spawn((ClothCollider::plane(), pose));
        let spacing = random(0.03, 0.05);
        let count = (1.3 / spacing) as u32;
        let cloth = match seed % 2 == 0 {
            true => Cloth::new(count, count, spacing).lying().centred(),
            false => irregular(count, spacing, &mut random),
        };
        let material = ClothMaterial {
            friction,
            ..ClothMaterial::COTTON
        };
        let settings = ClothSettings {
            particle_radius: THICK,
            ..default()
        };
        let lies = pose * Transform::from_xyz(0.0, THICK, 0.0);
        app.world_mut()
            .spawn((cloth, Pins::none(), material, settings, lies));
        let thing = spawn_on(&mut app, pose, block(mass, size), -0.4);
        tick(&mut app, 8);
        let along = pose.rotation * Vec3::X;
        change::<Body>(&mut app, thing, |body| body.velocity = along);
        let ticks = (0.7 / (friction * GRAVITY) / TICK) as usize;
        tick(&mut app, ticks);
        let lost = 1.0 - velocity(&app, thing).dot(along);
        let expected = friction * GRAVITY * TICK * ticks as f32;
        println!("{seed}: {mass} kg, μ {friction}: lost {lost} of {expected} m/s");
        assert!(
            (lost / expected - 1.0).abs() < 0.05,
            "{seed}: {mass} kg, μ {friction}: lost {lost} of {expected} m/s"
        );
        tick(&mut app, 64);
        let speed = velocity(&app, thing).length();
        assert!(speed < 1.0e-3, "{seed}: {speed} m/s at last");
    }
}

/// A tick begun again from a snapshot, with bodies that stand and slide, goes on to the last bit.
#[test]
fn what_stands_goes_on_from_a_snapshot() {
    let mut app = app_with_bodies();
    app.world_mut().spawn(ClothCollider::plane());
    let pose = Transform::default();
    let cloth = spawn_cloth(&mut app, pose, 0.4, Pins::new([Pin::Column(30)]));
    let stands = spawn_on(&mut app, pose, cup(0.3, 0.04, 0.1), -0.3);
    let slides = spawn_on(&mut app, pose, block(1.0, Vec3::splat(0.1)), 0.1);
    tick(&mut app, 16);
    change::<Body>(&mut app, slides, |body| body.velocity.z = 0.8);
    tick(&mut app, 4);
    let things = [stands, slides];
    let snapshot = ClothWorldSnapshot::of(app.world_mut());
    let known = things.map(|thing| {
        let world = app.world();
        let place = *world.get::<Transform>(thing).expect("a place");
        (place, *world.get::<Body>(thing).expect("a body"))
    });
    let run = |app: &mut App| {
        tick(app, 20);
        let bits = particles(app, cloth)
            .positions()
            .map(|place| place.to_array().map(f32::to_bits));
        let places = things.map(|thing| place(app, thing).to_array().map(f32::to_bits));
        (bits.collect::<Vec<_>>(), places)
    };
    let first = run(&mut app);
    snapshot.restore(app.world_mut()).expect("the same world");
    for (thing, (place, body)) in things.into_iter().zip(known) {
        app.world_mut().entity_mut(thing).insert((place, body));
    }
    assert!(run(&mut app) == first, "it went on otherwise");
}

/// Whatever axes are locked, nothing is lost.
#[test]
fn locked_bodies_stand() {
    for locks in 0..64_u32 {
        let mut app = app_with_bodies();
        app.world_mut().spawn(ClothCollider::plane());
        let pose = Transform::default();
        let cloth = spawn_cloth(&mut app, pose, 0.5, Pins::none());
        let (collider, height, body) = block(1.0, Vec3::new(0.16, 0.06, 0.16));
        let is = |bit: u32| locks & (1 << bit) != 0;
        let body = ClothBody {
            locked_translation: BVec3::new(is(0), is(1), is(2)),
            locked_rotation: BVec3::new(is(3), is(4), is(5)),
            ..body
        };
        let thing = spawn_on(&mut app, pose, (collider, height, body), 0.0);
        // It begins a little too low.
        change::<Transform>(&mut app, thing, |place| place.translation.y -= 0.002);
        if is(1) {
            change::<Body>(&mut app, thing, |body| body.gravity = 0.0);
        }
        tick(&mut app, 32);
        let high = place(&app, thing).y - height - ABOVE;
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        let is_finite = contacts.iter().all(|contact| contact.impulse.is_finite());
        let held = is(1) || high.abs() < 1.0e-4;
        assert!(high.is_finite() && is_finite && held, "{locks:b}: {high} m");
    }
}

/// A block that falls across two cloths, or has another one on it, is held once, and does not bounce.
#[test]
fn a_block_stands_on_two_cloths() {
    for is_on_top in [false, true] {
        let mut app = app_with_bodies();
        app.world_mut().spawn(ClothCollider::plane());
        let half = |x: f32, y: f32| {
            let settings = ClothSettings {
                particle_radius: THICK,
                ..default()
            };
            let place = Transform::from_xyz(x, THICK + y, 0.0);
            let cloth = Cloth::new(11, 11, 0.03).lying().centred();
            (cloth, Pins::none(), settings, place)
        };
        match is_on_top {
            true => app
                .world_mut()
                .spawn_batch([half(0.0, 0.0), half(0.0, 0.15)]),
            false => app
                .world_mut()
                .spawn_batch([half(-0.155, 0.0), half(0.155, 0.0)]),
        };
        let pose = Transform::from_xyz(0.0, 0.05, 0.0);
        let thing = block(1.0, Vec3::new(0.16, 0.06, 0.16));
        let thing = spawn_on(&mut app, pose, thing, 0.0);
        let mut highest = f32::MIN;
        for count in 0..96 {
            tick(&mut app, 1);
            if count > 12 {
                highest = highest.max(place(&app, thing).y - 0.03 - ABOVE);
            }
        }
        let rests = place(&app, thing).y - 0.03 - ABOVE;
        println!("on top {is_on_top}: rests {rests} m too high, {highest} at most");
        assert!(
            rests.abs() < 5.0e-4 && highest < 5.0e-3,
            "{is_on_top}: {rests}, {highest}"
        );
    }
}

/// Random things of 10 g to 30 kg on random cloth, grids and meshes, on a plane that tilts by up to two thirds of the angle of
/// friction, or on a table: they stand where they were put, and still, and the cloth knows of them.
#[test]
fn random_things_stand() {
    for seed in 0..if is_long() { 200 } else { 20 } {
        let mut state = seed * 7_919 + 3;
        let mut random = |low: f32, high: f32| low + (high - low) * next(&mut state);
        let (friction, radius) = (random(0.2, 0.9), random(0.002, 0.012));
        let mass = 10.0_f32.powf(random(-2.0, 1.5));
        let is_table = random(0.0, 1.0) < 0.3;
        let tilt = match is_table {
            true => 0.0,
            false => (random(0.0, 0.66) * friction).atan(),
        };
        let pose = Transform::from_xyz(random(-3.0, 3.0), random(0.0, 2.0), 0.0).with_rotation(
            Quat::from_rotation_z(-tilt)
                * Quat::from_rotation_y(random(0.0, std::f32::consts::TAU)),
        );
        let thing = match random(0.0, 1.0) < 0.5 {
            true => block(
                mass,
                Vec3::new(random(0.05, 0.3), random(0.01, 0.08), random(0.05, 0.3)),
            ),
            false => cup(mass, random(0.03, 0.15), random(0.02, 0.06)),
        };
        let spacing = random(0.02, 0.05);
        let count = (0.7 / spacing) as u32;
        let mut app = app_with_bodies();
        let table = pose * Transform::from_xyz(0.0, -0.05, 0.0);
        match (is_table, random(0.0, 1.0) < 0.5) {
            (true, true) => app
                .world_mut()
                .spawn((ClothCollider::cuboid(1.6, 0.1, 1.6), table)),
            (true, false) => app.world_mut().spawn((board(1.6, 0.1), table)),
            (false, _) => app.world_mut().spawn((ClothCollider::plane(), pose)),
        };
        let cloth = match random(0.0, 1.0) < 0.5 {
            true => Cloth::new(count, count, spacing).lying().centred(),
            false => irregular(count, spacing, &mut random),
        };
        let cloth = app.world_mut().spawn((
            cloth,
            Pins::none(),
            ClothMaterial {
                friction,
                ..ClothMaterial::COTTON
            },
            ClothSettings {
                particle_radius: radius,
                ..default()
            },
            pose * Transform::from_xyz(0.0, radius, 0.0),
        ));
        let cloth = cloth.id();
        let height = thing.1 + 2.1 * radius;
        let thing = spawn_on(&mut app, pose, thing, random(-0.1, 0.1));
        change::<Transform>(&mut app, thing, |place| {
            place.translation += pose.up() * (2.1 * radius - ABOVE);
        });
        tick(&mut app, 32);
        let start = place(&app, thing);
        tick(&mut app, 64);
        let (now, up) = (place(&app, thing), *pose.up());
        let above = (now - pose.translation).dot(up) - height;
        let (crept, leans) = (now.distance(start), lean(&app, thing, up));
        let about = format!("{seed}: {mass} kg, μ {friction}, tilt {tilt}, radius {radius}");
        println!("{about}: crept {crept}, above {above}, leans {leans}");
        assert!(
            crept < 1.0e-3 && above.abs() < 0.1 * radius && leans < 0.5,
            "{about}: crept {crept} m, {above} m too high, leans {leans}°"
        );
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        let impulse = contacts.with(thing).map(|contact| contact.impulse.dot(up));
        let weight = mass * GRAVITY * TICK * tilt.cos();
        assert!(
            impulse.is_some_and(|impulse| (impulse / weight - 1.0).abs() < 0.01),
            "{about}: impulse {impulse:?} of {weight}"
        );
    }
}

/// A square table top as a mesh of twelve triangles, of a side and a height (m).
fn board(side: f32, height: f32) -> ClothCollider {
    let half = Vec3::new(side, height, side) / 2.0;
    let corner = |index: u32| {
        let sign = |bit: u32| if index & (1 << bit) == 0 { -1.0 } else { 1.0 };
        half * Vec3::new(sign(0), sign(1), sign(2))
    };
    let corners: Vec<Vec3> = (0..8).map(corner).collect();
    // Each face, seen from outside, against the clock.
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    ClothCollider::trimesh(corners, triangles.collect::<Vec<[u32; 3]>>())
}

/// A number from 0 to 1.
fn next(state: &mut u64) -> f32 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f32 / (1_u32 << 24) as f32
}

/// A lying square of so many vertices a side, moved by up to 0.15 spacings (m), with random diagonals.
fn irregular(count: u32, spacing: f32, random: &mut impl FnMut(f32, f32) -> f32) -> Cloth {
    let half = spacing * (count - 1) as f32 / 2.0;
    let (mut corners, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..count {
        for column in 0..count {
            let mut off = || 0.15 * spacing * random(-1.0, 1.0);
            let (x, z) = (spacing * column as f32 - half, spacing * row as f32 - half);
            corners.push(Vec3::new(x + off(), 0.0, z + off()));
            if row + 1 < count && column + 1 < count {
                let a = row * count + column;
                let (b, c, d) = (a + 1, a + count, a + count + 1);
                triangles.extend(match random(0.0, 1.0) < 0.5 {
                    true => [[a, c, b], [b, c, d]],
                    false => [[a, c, d], [a, d, b]],
                });
            }
        }
    }
    Cloth::triangles(corners, triangles)
}
