//! Bodies that have come to rest on cloth: both sleep, and wake by whatever would move one of them.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{
    Collider, ColliderMassProperties, ExternalImpulse, RapierRigidBodyHandle, RapierRigidBodySet,
    RigidBody,
};

use crate::{
    fuzz::random::Random, push_back::*, rapier::app_with_rapier, shared_meshes::irregular, stands,
    support::*,
};

fn push(app: &App, body: Entity) -> ClothPush {
    *app.world().get::<ClothPush>(body).expect("a push")
}

/// Ticks until a cloth sleeps and holds a body, up to 30 s.
fn sleeps_after(app: &mut App, [cloth, body]: [Entity; 2]) -> Option<u32> {
    (1..64 * 30).find(|_| {
        tick(app, 1);
        stats(app, cloth).is_asleep && push(app, body).is_held
    })
}

/// Checks that for a second a body stays within a particle's radius of a place.
fn assert_stays(app: &mut App, body: Entity, at: Vec3, name: &str) {
    let moved = (0..64).map(|_| {
        tick(app, 1);
        place(app, body).distance(at)
    });
    let moved = moved.fold(0.0, f32::max);
    println!("{name}: moved by {moved} m");
    assert!(moved < 0.01, "{name}: moved by {moved} m");
}

/// A cup on a cloth that lies on a table.
fn laid_table(mass: f32) -> (App, [Entity; 2]) {
    let mut app = app_with_bodies();
    app.world_mut().spawn((
        ClothCollider::cuboid(1.4, 0.04, 1.4),
        Transform::from_xyz(0.0, -0.02, 0.0),
    ));
    let pose = Transform::default();
    let cloth = stands::spawn_cloth(&mut app, pose, 0.3, Pins::none());
    let cup = stands::spawn_on(&mut app, pose, stands::cup(mass, 0.04, 0.1), 0.1);
    (app, [cloth, cup])
}

/// A ball in a sheet that is held by its border, of a damping that lets both come to rest soon.
fn trampoline(mass: f32, radius: f32, particles: u32) -> (App, [Entity; 2]) {
    let mut app = app_with_bodies();
    let sheet = spawn_trampoline(&mut app, particles);
    change::<ClothMaterial>(&mut app, sheet, |material| material.damping = 0.05);
    let ball = spawn_ball(&mut app, mass, radius, Vec3::Y * (radius + 0.02));
    (app, [sheet, ball])
}

/// Nothing moves by a bit while both sleep: neither in the next tick nor in four seconds. The body has no velocity but for rounding. That
/// of gravity in a tick is given and taken by way of places, which are rounded to 10⁻⁷ m: in 1/64 s, to 10⁻⁵ m/s.
#[test]
fn a_cloth_and_the_body_on_it_sleep() {
    let scenes = [
        ("cup of 0.1 kg", laid_table(0.1)),
        ("cup of 2 kg", laid_table(2.0)),
        ("light ball", trampoline(0.05, 0.08, 13)),
        ("ball", trampoline(0.2, 0.12, 17)),
        ("heavy ball", trampoline(1.0, 0.1, 13)),
    ];
    for (name, (mut app, [cloth, body])) in scenes {
        let after = sleeps_after(&mut app, [cloth, body]);
        println!("{name}: asleep after {after:?} ticks");
        assert!(after.is_some(), "{name}: {:?}", stats(&app, cloth));
        tick(&mut app, 1);
        let (before, at) = (particles(&app, cloth).clone(), place(&app, body));
        for count in 0..256 {
            tick(&mut app, 1);
            let stats = stats(&app, cloth);
            assert!(stats.is_asleep && stats.substeps == 0, "{name}: {count}");
            assert_eq!(particles(&app, cloth), &before, "{name}: {count}");
            assert_eq!(place(&app, body), at, "{name}: {count}");
            let speed = velocity(&app, body).length();
            assert!(speed < 3.0e-5, "{name}: {count}: {speed} m/s");
        }
    }
}

/// A thing on a sheet: on a table that may lean, or in the air, held by the border. The sheet is a grid or an irregular mesh.
fn anywhere(random: &mut Random) -> (App, [Entity; 2], String) {
    let mut app = app_with_bodies();
    let (is_mesh, on_table) = (random.one_in(2), random.one_in(2));
    let friction = 0.2 + 0.6 * random.part();
    let kind = random.below(3);
    let is_ball = kind == 2 && !on_table;
    // Half the angle of friction; a ball would roll off.
    let most = if is_ball { 0.0 } else { 0.5 * friction.atan() };
    let lean = Quat::from_rotation_z(most * random.part());
    let pose = Transform::from_rotation(Quat::from_rotation_y(6.0 * random.part()) * lean);
    let thick = 0.004;
    let is_border =
        move |at: Vec3| (at - at.clamp(Vec3::splat(-0.48), Vec3::splat(0.48))).xy() != Vec2::ZERO;
    let pins = match on_table {
        true => Pins::new([Pin::at_rest(move |at| at.x < -0.48)]),
        false => Pins::new([Pin::at_rest(is_border)]),
    };
    let cloth = match is_mesh {
        true => {
            let mesh = irregular(1.0, 1.0, 0.05, 0.3);
            let middle = Vec3::new(-0.5, 0.5, 0.0);
            Cloth::triangles(mesh.positions.iter().map(|at| *at + middle), mesh.triangles)
        }
        false => Cloth::new(21, 21, 0.05).centred(),
    };
    if on_table {
        let table = (ClothCollider::plane(), pose);
        app.world_mut().spawn(table);
    }
    let material = ClothMaterial {
        friction,
        damping: 0.05,
        ..ClothMaterial::COTTON
    };
    let settings = ClothSettings {
        particle_radius: thick,
        ..default()
    };
    let lying = pose * flat(0.0, thick, 0.0);
    let cloth = (app.world_mut()).spawn((cloth, pins, material, settings, lying));
    let cloth = cloth.id();
    let mass = 0.05 * 40.0_f32.powf(random.part());
    let thing = match kind {
        0 => stands::cup(mass, 0.06, 0.1),
        1 => stands::block(mass, Vec3::new(0.16, 0.06, 0.12)),
        _ if on_table => stands::block(mass, Vec3::splat(0.1)),
        _ => (ClothCollider::ball(0.1), 0.1, ClothBody::ball(mass, 0.1)),
    };
    let body = stands::spawn_on(&mut app, pose, thing, 0.2 * random.part() - 0.1);
    let name = format!(
        "{} of {mass:.2} kg on a {} {}, leaning by {:.0}°, μ {friction:.2}",
        if is_ball {
            "a ball"
        } else {
            ["a cup", "a block", "a cube"][kind]
        },
        ["grid", "mesh"][usize::from(is_mesh)],
        ["held by its border", "on a table"][usize::from(on_table)],
        lean.to_axis_angle().1.to_degrees()
    );
    (app, [cloth, body], name)
}

/// Cups and blocks sleep with the cloth that they lie on. A ball may roll on by a centimetre a second: nothing brakes it.
#[test]
fn whatever_lies_on_cloth_sleeps_and_balls_are_calm() {
    let mut random = Random(11);
    for _ in 0..if is_long() { 100 } else { 8 } {
        let (mut app, things, name) = anywhere(&mut random);
        let after = sleeps_after(&mut app, things);
        println!("{name}: asleep after {after:?} ticks");
        let may_roll = name.contains("a ball");
        assert!(after.is_some() || may_roll, "{name} is awake");
        assert_calm(&mut app, things, &name);
    }
}

/// Checks that for a second a body stays within a centimetre. No particle of a cloth that is awake is faster than 0.46 m/s, thrice the
/// speed that gravity gives it in a tick. Where all carriers bore alike, particles below small balls had 0.8 to 5 m/s.
fn assert_calm(app: &mut App, [cloth, body]: [Entity; 2], name: &str) {
    let at = place(app, body);
    for _ in 0..64 {
        tick(app, 1);
        let moved = place(app, body).distance(at);
        let particles = particles(app, cloth);
        let speeds = (0..particles.len()).filter_map(|index| particles.velocity(index));
        let fastest = speeds.map(Vec3::length).fold(0.0, f32::max);
        let is_calm = stats(app, cloth).is_asleep || fastest < 3.0 * GRAVITY * TICK;
        assert!(
            moved < 0.01 && is_calm,
            "{name}: moved by {moved} m, {fastest} m/s"
        );
    }
}

/// Small balls of three to thirteen times the mass of their sheet, which a few triangles hold, come to rest.
#[test]
fn a_small_heavy_ball_does_not_jitter() {
    for (along, mass) in [(21, 1.0), (21, 2.0), (31, 0.5), (31, 1.0)] {
        let mut app = app_with_bodies();
        let sheet = spawn_trampoline(&mut app, along);
        change::<ClothMaterial>(&mut app, sheet, |material| {
            (material.damping, material.friction) = (0.05, 0.5);
        });
        change::<ClothSettings>(&mut app, sheet, |settings| settings.particle_radius = 0.004);
        let ball = spawn_ball(&mut app, mass, 0.1, Vec3::new(0.013, 0.12, 0.007));
        tick(&mut app, 64 * 18);
        assert_calm(&mut app, [sheet, ball], &format!("{mass} kg on {along}²"));
    }
}

/// Each motion of one of them wakes the cloth, by the third tick. Where nothing moves the body, it stays within a particle's radius for a
/// second, and both sleep again.
#[test]
fn what_would_move_either_wakes_both() {
    type Wake = fn(&mut App, [Entity; 2]);
    let wakes: [(&str, bool, Wake); 10] = [
        ("a knock", true, |app, [_, body]| {
            change::<Body>(app, body, |body| body.velocity.x += 0.3);
        }),
        ("a spin", true, |app, [_, body]| {
            change::<Body>(app, body, |body| body.spin.y += 5.0);
        }),
        ("less gravity", false, |app, [_, body]| {
            change::<Body>(app, body, |body| body.gravity *= 0.9);
        }),
        ("a mass", false, |app, [_, body]| {
            change::<ClothBody>(app, body, |body| body.mass *= 1.01);
        }),
        ("a teleport", true, |app, [_, body]| {
            change::<Transform>(app, body, |place| place.translation.y += 0.05);
        }),
        ("a touch", true, |app, [_, body]| {
            let at = place(app, body) + Vec3::new(0.3, -0.05, 0.0);
            (app.world_mut()).spawn((ClothCollider::ball(0.08), Transform::from_translation(at)));
        }),
        ("a setting", false, |app, [cloth, _]| {
            change::<ClothSettings>(app, cloth, |settings| settings.order = TimeOrder::First);
        }),
        ("a breath", false, |app, _| {
            app.insert_resource(ClothWind::new(Vec3::new(0.2, 0.0, 0.0)));
        }),
        ("a hand that picks it up", true, |app, [_, body]| {
            let hand = Transform::from_xyz(0.1, 0.5, 0.2).with_rotation(Quat::from_rotation_z(0.4));
            let hand = app.world_mut().spawn(hand).id();
            app.world_mut().entity_mut(body).set_parent_in_place(hand);
        }),
        ("its end as a body", true, |app, [_, body]| {
            app.world_mut().entity_mut(body).remove::<ClothBody>();
        }),
    ];
    for scene in [|| laid_table(0.3), || trampoline(0.2, 0.12, 13)] {
        for (name, moves_on, wake) in wakes {
            let (mut app, both) = scene();
            let [cloth, body] = both;
            assert!(sleeps_after(&mut app, both).is_some(), "{name}");
            tick(&mut app, 8);
            let at = place(&app, body);
            wake(&mut app, both);
            let ticks = (1..=3).find(|_| {
                tick(&mut app, 1);
                !stats(&app, cloth).is_asleep
            });
            println!("{name}: awake after {ticks:?}");
            assert!(ticks.is_some() && !push(&app, body).is_held, "{name}");
            if moves_on {
                continue;
            }
            assert_stays(&mut app, body, at, name);
            assert!(
                sleeps_after(&mut app, both).is_some(),
                "{name}: never again"
            );
        }
    }
}

/// A force that holds on moves a body as if it had never slept, from a twentieth of its weight on: along a table without friction.
#[test]
fn a_body_at_rest_is_not_glued() {
    let mut app = app_with_bodies();
    app.world_mut()
        .spawn((ClothCollider::plane(), Transform::default()));
    let pose = Transform::default();
    let cloth = stands::spawn_cloth(&mut app, pose, 0.0, Pins::new([Pin::Row(0), Pin::Row(30)]));
    let block = stands::block(0.5, Vec3::new(0.16, 0.06, 0.16));
    let block = stands::spawn_on(&mut app, pose, block, 0.0);
    assert!(sleeps_after(&mut app, [cloth, block]).is_some());
    tick(&mut app, 8);
    let at = place(&app, block).x;
    let pull = 0.06 * GRAVITY;
    for _ in 0..64 {
        change::<Body>(&mut app, block, |body| body.velocity.x += pull * TICK);
        tick(&mut app, 1);
    }
    let (gone, expected) = (place(&app, block).x - at, pull / 2.0);
    println!("{gone} m of {expected}");
    assert!(
        (gone / expected - 1.0).abs() < 0.1,
        "{gone} m of {expected}"
    );
}

/// A ball of 0.2 kg of rapier's, which cloth pushes back.
fn rapier_ball(place: Vec3) -> impl Bundle {
    (
        RigidBody::Dynamic,
        Collider::ball(0.1),
        ColliderMassProperties::Mass(0.2),
        ExternalImpulse::default(),
        RapierClothCollider,
        ClothPushBack,
        Transform::from_translation(place),
    )
}

/// Whether a body sleeps in rapier.
fn sleeps_in_rapier(app: &mut App, body: Entity) -> bool {
    let handle = app.world().get::<RapierRigidBodyHandle>(body);
    let handle = handle.expect("it is in rapier").0;
    let mut sets = app.world_mut().query::<&RapierRigidBodySet>();
    let set = sets.single(app.world()).expect("one context");
    set.bodies.get(handle).expect("a body").is_sleeping()
}

/// A body of rapier's sleeps with the cloth, and wakes with it: in the same tick, or when what falls on it gets there. A breath of wind
/// that does not move it leaves it where it is, to a particle's radius.
#[test]
fn a_rapier_body_sleeps_with_its_cloth() {
    let mut app = app_with_rapier();
    let sheet = spawn_trampoline(&mut app, 13);
    change::<ClothMaterial>(&mut app, sheet, |material| material.damping = 0.05);
    let body = app.world_mut().spawn(rapier_ball(Vec3::Y * 0.12)).id();
    // Rapier rounds a rotation on its way into it and out of it.
    change::<Transform>(&mut app, body, |place| {
        place.rotation = Quat::from_euler(EulerRot::XYZ, 0.7, -1.1, 2.3);
    });
    tick(&mut app, 8);
    type Wake = fn(&mut App, Entity);
    let wakes: [(&str, u32, Wake); 3] = [
        ("a knock", 1, |app, body| {
            change::<ExternalImpulse>(app, body, |impulse| impulse.impulse = Vec3::X * 0.04);
        }),
        ("a breath", 1, |app, _| {
            app.insert_resource(ClothWind::new(Vec3::new(0.2, 0.0, 0.0)));
        }),
        ("a ball that drops on it", 32, |app, _| {
            app.world_mut()
                .spawn(rapier_ball(Vec3::new(0.02, 0.45, 0.0)));
        }),
    ];
    for (name, within, wake) in wakes {
        assert!(sleeps_after(&mut app, [sheet, body]).is_some(), "{name}");
        tick(&mut app, 2);
        let at = place(&app, body);
        for count in 0..256 {
            tick(&mut app, 1);
            let both = [
                sleeps_in_rapier(&mut app, body),
                stats(&app, sheet).is_asleep,
            ];
            assert_eq!(both, [true; 2], "{name}: {count}");
            assert_eq!(place(&app, body), at, "{name}: {count}");
        }
        wake(&mut app, body);
        let awake = (1..=within).find(|_| {
            tick(&mut app, 1);
            !sleeps_in_rapier(&mut app, body) && !stats(&app, sheet).is_asleep
        });
        println!("{name}: awake after {awake:?}");
        assert!(awake.is_some(), "{name}");
        if name == "a breath" {
            assert_stays(&mut app, body, at, name);
        }
    }
}

/// Without `ClothPushBack` it is on its own, and does not hang in the air where the cloth held it.
#[test]
fn a_rapier_body_that_is_released_falls() {
    let mut app = app_with_rapier();
    let sheet = spawn_trampoline(&mut app, 13);
    change::<ClothMaterial>(&mut app, sheet, |material| material.damping = 0.05);
    let body = app.world_mut().spawn(rapier_ball(Vec3::Y * 0.12)).id();
    tick(&mut app, 8);
    assert!(sleeps_after(&mut app, [sheet, body]).is_some());
    tick(&mut app, 8);
    let at = place(&app, body);
    app.world_mut().entity_mut(body).remove::<ClothPushBack>();
    tick(&mut app, 32);
    let fallen = at.y - place(&app, body).y;
    // Half a second of free fall.
    assert!(fallen > 0.9 * GRAVITY / 8.0, "{fallen} m");
}

/// A cloth that stands still by its level of detail holds nothing: what lay on it is knocked off and falls.
#[test]
fn a_cloth_that_stands_still_holds_nothing() {
    let (mut app, both) = trampoline(0.2, 0.12, 13);
    let [cloth, body] = both;
    assert!(sleeps_after(&mut app, both).is_some());
    tick(&mut app, 8);
    let at = place(&app, body);
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothLod::at(ClothLodLevel::Off));
    change::<Body>(&mut app, body, |body| body.velocity.x += 0.3);
    tick(&mut app, 16);
    assert!(!push(&app, body).is_held);
    let gone = place(&app, body) - at;
    assert!(gone.x > 0.06 && gone.y < -0.2, "{gone}");
}

/// A restored snapshot goes on to the bit, whether cloth and body sleep in it or are about to.
#[test]
fn what_sleeps_is_restored_to_the_bit() {
    let (mut app, both) = trampoline(0.2, 0.12, 13);
    let [cloth, body] = both;
    let state = |app: &App| {
        let moving = *app.world().get::<Body>(body).expect("a body");
        let place = *app.world().get::<Transform>(body).expect("a place");
        (place, moving.velocity, moving.spin)
    };
    let after = sleeps_after(&mut app, both).expect("it sleeps") as usize;
    for back in [0, 1, 2, 20, after / 2] {
        let (mut app, [cloth_too, _]) = trampoline(0.2, 0.12, 13);
        assert_eq!(cloth, cloth_too, "the same app again");
        tick(&mut app, after - back);
        let saved = ClothWorldSnapshot::of(app.world_mut());
        let (place, ..) = state(&app);
        let moving = *app.world().get::<Body>(body).expect("a body");
        let run = |app: &mut App| {
            let mut ways = Vec::new();
            for _ in 0..back + 16 {
                tick(app, 1);
                ways.push((
                    state(app).0,
                    stats(app, cloth).is_asleep,
                    particles(app, cloth).clone(),
                ));
            }
            ways
        };
        let first = run(&mut app);
        assert!(first.last().expect("it ran").1, "{back}: it sleeps");
        change::<Body>(&mut app, body, |body| body.velocity.x += 0.5);
        tick(&mut app, 5);
        *app.world_mut().get_mut::<Transform>(body).expect("a place") = place;
        *app.world_mut().get_mut::<Body>(body).expect("a body") = moving;
        saved.restore(app.world_mut()).expect("it fits");
        let second = run(&mut app);
        for (count, (first, second)) in first.iter().zip(&second).enumerate() {
            assert_eq!(first.1, second.1, "{back} before, tick {count}");
            assert_eq!(first.0, second.0, "{back} before, tick {count}");
            assert!(first.2 == second.2, "{back} before, tick {count}");
        }
    }
}
