//! Rapier bodies that cloth pushes back.

use bevy::{math::DVec3, prelude::*};
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{
    Collider, ColliderMassProperties, GravityScale, LockedAxes, ReadMassProperties, RigidBody,
    Velocity,
};

use crate::{push_back::cloth_momentum, rapier::app_with_rapier, support::*};

const RADIUS: f32 = 0.15;

/// Ticks that rapier and the bridge take to know a body, its mass and its way.
const TO_BEGIN: usize = 4;

/// Something in space, without gravity; `C` says whether cloth pushes it back.
fn spawn_body<C: Bundle>(
    app: &mut App,
    mass: f32,
    (collider, place): (Collider, Transform),
    push_back: C,
) -> Entity {
    let body = (
        RigidBody::Dynamic,
        Velocity::default(),
        GravityScale(0.0),
        collider,
        ColliderMassProperties::Mass(mass),
        RapierClothCollider,
        push_back,
        place,
    );
    app.world_mut().spawn(body).id()
}

fn spawn_ball<C: Bundle>(app: &mut App, mass: f32, push_back: C) -> Entity {
    let ball = (Collider::ball(RADIUS), Transform::default());
    spawn_body(app, mass, ball, push_back)
}

/// A sheet in space that no pin holds, as far from the ball as `at` says, square to that.
fn spawn_sheet(app: &mut App, at: Vec3) -> Entity {
    let material = ClothMaterial {
        damping: 0.0,
        ..ClothMaterial::COTTON
    };
    let settings = ClothSettings {
        gravity: Some(Vec3::ZERO),
        ..default()
    };
    let place = Transform::from_translation(at)
        .with_rotation(Quat::from_rotation_arc(Vec3::Z, at.normalize()));
    let sheet = (
        Cloth::new(17, 17, 0.05).centred(),
        Pins::none(),
        material,
        settings,
        place,
    );
    app.world_mut().spawn(sheet).id()
}

/// Has all of a sheet move at a velocity in the world (m/s).
fn throw(app: &mut App, sheet: Entity, velocity: Vec3) {
    let frame = *app.world().get::<ClothFrame>(sheet).expect("a frame");
    let velocity = frame.isometry().rotation.inverse() * velocity;
    change::<ClothParticles>(app, sheet, |particles| {
        for index in 0..particles.len() {
            particles.set_velocity(index, velocity).expect("it exists");
        }
    });
}

fn velocity(app: &App, ball: Entity) -> Velocity {
    *app.world().get::<Velocity>(ball).expect("a velocity")
}

/// Momentum of a ball and of the sheets (kg·m/s).
fn momentum(app: &App, (ball, mass): (Entity, f32), sheets: &[Entity]) -> DVec3 {
    let of_sheets = sheets.iter().map(|&sheet| cloth_momentum(app, sheet).0);
    f64::from(mass) * velocity(app, ball).linear.as_dvec3() + of_sheets.sum::<DVec3>()
}

/// What a sheet loses of its momentum is what rapier's body has, whether that is a tenth as heavy or a hundred times: positions and
/// velocities are floats, so a part in 10⁷ some dozen times a tick, 64 ticks long, of which signs differ. And what two bodies
/// have in common after an impact without a bounce is the least that the ball gets.
#[test]
fn a_rapier_body_gets_what_the_cloth_lost() {
    for mass in [0.01_f32, 0.1, 1.0, 10.0] {
        let mut app = app_with_rapier();
        let ball = spawn_ball(&mut app, mass, ClothPushBack);
        let sheet = spawn_sheet(&mut app, Vec3::new(0.1, 0.25, -0.1));
        tick(&mut app, TO_BEGIN);
        let speed = Vec3::new(-0.8, -2.0, 0.8);
        throw(&mut app, sheet, speed);
        let (start, sheet_mass) = cloth_momentum(&app, sheet);
        let mut worst = 0.0_f64;
        for _ in 0..64 {
            tick(&mut app, 1);
            let off = momentum(&app, (ball, mass), &[sheet]) - start;
            worst = worst.max(off.length());
        }
        let relative = worst / start.length();
        println!("{mass} kg: off by {relative}");
        assert!(
            relative < 1.0e-5,
            "{mass} kg: momentum is off by {relative}"
        );
        let gone = velocity(&app, ball).linear.dot(speed.normalize());
        let common = speed.length() * sheet_mass as f32 / (sheet_mass as f32 + mass);
        // It strikes beside the middle, and some of the sheet goes past.
        assert!(gone > 0.3 * common, "{mass} kg: {gone} m/s of {common}");
    }
}

/// Two sheets that strike one body, from two sides and at different times, both push it, and nothing of their momentum is lost:
/// neither while one touches, nor while both do.
#[test]
fn two_cloths_push_one_rapier_body() {
    for mass in [0.05_f32, 0.5, 5.0] {
        let mut app = app_with_rapier();
        let ball = spawn_ball(&mut app, mass, ClothPushBack);
        let first = spawn_sheet(&mut app, Vec3::Y * 0.25);
        let second = spawn_sheet(&mut app, Vec3::X * 0.3);
        tick(&mut app, TO_BEGIN);
        throw(&mut app, first, Vec3::NEG_Y * 2.0);
        throw(&mut app, second, Vec3::NEG_X * 1.5);
        let sheets = [first, second];
        let start = momentum(&app, (ball, mass), &sheets);
        let (mut worst, mut together) = (0.0_f64, 0);
        for _ in 0..64 {
            tick(&mut app, 1);
            let off = momentum(&app, (ball, mass), &sheets) - start;
            worst = worst.max(off.length());
            let touches = sheets.map(|sheet| {
                let contacts = app.world().get::<ClothContacts>(sheet).expect("contacts");
                contacts.with(ball).is_some()
            });
            together += usize::from(touches == [true; 2]);
        }
        let relative = worst / start.length();
        println!("{mass} kg: off by {relative}, {together} ticks together");
        assert!(together > 5, "{mass} kg: {together} ticks together");
        assert!(
            relative < 1.0e-5,
            "{mass} kg: momentum is off by {relative}"
        );
        // Each has pushed along its way.
        let velocity = velocity(&app, ball).linear;
        let (_, sheet_mass) = cloth_momentum(&app, first);
        let common = sheet_mass as f32 / (sheet_mass as f32 + mass);
        assert!(
            -velocity.y > 0.25 * 2.0 * common && -velocity.x > 0.25 * 1.5 * common,
            "{mass} kg: {velocity}"
        );
    }
}

/// Without the component rapier moves its bodies as if there was no cloth, to the last bit.
#[test]
fn without_push_back_cloth_moves_nothing() {
    let run = |with_cloth: bool| {
        let mut app = app_with_rapier();
        let ball = spawn_ball(&mut app, 0.1, ());
        let sheet = with_cloth.then(|| spawn_sheet(&mut app, Vec3::Y * 0.25));
        tick(&mut app, TO_BEGIN);
        if let Some(sheet) = sheet {
            throw(&mut app, sheet, Vec3::NEG_Y * 2.0);
        }
        change::<Velocity>(&mut app, ball, |velocity| {
            *velocity = Velocity {
                linear: Vec3::new(0.1, 0.3, -0.2),
                angular: Vec3::new(0.5, -0.3, 0.2),
            };
        });
        let mut is_touched = false;
        let way: Vec<(Transform, Velocity)> = (0..64)
            .map(|_| {
                tick(&mut app, 1);
                if let Some(sheet) = sheet {
                    let contacts = app.world().get::<ClothContacts>(sheet).expect("contacts");
                    is_touched |= contacts.with(ball).is_some();
                }
                let transform = app.world().get::<Transform>(ball).expect("a transform");
                (*transform, velocity(&app, ball))
            })
            .collect();
        assert_eq!(is_touched, with_cloth);
        way
    };
    let (with, without) = (run(true), run(false));
    for (tick, (with, without)) in with.iter().zip(&without).enumerate() {
        assert_eq!(with.0, without.0, "tick {tick}");
        assert_eq!(with.1.linear, without.1.linear, "tick {tick}");
        assert_eq!(with.1.angular, without.1.angular, "tick {tick}");
    }
}

/// A capsule is pushed the same however it is written down: along the entity's y and turned with it, along its x, or beside it. A
/// particle that touches in one run, and by a rounding not in another, is one in 289: a few of these are 3 % of what is given.
#[test]
fn a_shape_aside_is_pushed_like_one_that_is_not() {
    let run = |collider: Collider, place: Transform| {
        let mut app = app_with_rapier();
        let body = spawn_body(&mut app, 0.1, (collider, place), ClothPushBack);
        let sheet = spawn_sheet(&mut app, Vec3::Y * 0.2);
        tick(&mut app, TO_BEGIN);
        let frame = *app.world().get::<ClothFrame>(sheet).expect("a frame");
        // Beside the middle, so that it turns.
        change::<ClothParticles>(&mut app, sheet, |particles| {
            for index in 0..particles.len() {
                let place = particles.position(index).expect("it exists");
                let beside = frame.isometry() * place + Vec3::new(0.15, 0.0, 0.02);
                let beside = frame.isometry().inverse() * beside;
                particles.set_position(index, beside).expect("it exists");
            }
        });
        throw(&mut app, sheet, Vec3::NEG_Y * 2.0);
        let mut way = Vec::new();
        for _ in 0..32 {
            tick(&mut app, 1);
            let transform = app.world().get::<Transform>(body).expect("a transform");
            let mass = app.world().get::<ReadMassProperties>(body);
            let centre = mass.expect("a mass").local_center_of_mass;
            let moved = velocity(&app, body);
            way.push([
                transform.transform_point(centre),
                moved.linear,
                moved.angular,
            ]);
        }
        way
    };
    let (half, radius) = (0.2, 0.1);
    let turned = Transform::from_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    let upright = run(Collider::capsule_y(half, radius), turned);
    let along_x = run(Collider::capsule_x(half, radius), Transform::IDENTITY);
    let ends = [-half, half].map(|x| Vec3::new(x + 0.5, 0.1, 0.0));
    let aside = run(
        Collider::capsule(ends[0], ends[1], radius),
        Transform::from_xyz(-0.5, -0.1, 0.0),
    );
    let [_, fastest, spin] = upright.last().expect("it ran");
    assert!(
        fastest.length() > 0.3 && spin.length() > 0.3,
        "{fastest} {spin}"
    );
    for (name, way) in [("along x", along_x), ("aside", aside)] {
        for figure in 0..3 {
            let largest = upright.iter().map(|each| each[figure].length());
            let largest = largest.fold(0.0, f32::max);
            let both = upright.iter().zip(&way);
            let off = both.map(|(expected, found)| expected[figure].distance(found[figure]));
            let off = off.fold(0.0, f32::max) / largest;
            println!("{name}: figure {figure} is off by {off} of {largest}");
            assert!(off < 0.03, "{name}: figure {figure} is off by {off}");
        }
    }
}

/// Cloth moves and turns a body along and about no axis of the world that rapier has locked, to the last bit, however the body is
/// turned; about the others it turns it.
#[test]
fn locked_axes_are_the_worlds() {
    let mut app = app_with_rapier();
    let turned = Transform::from_rotation(Quat::from_rotation_y(0.7));
    let capsule = (Collider::capsule_x(0.2, 0.1), turned);
    let body = spawn_body(&mut app, 0.1, capsule, ClothPushBack);
    let locked = LockedAxes::ROTATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Y;
    app.world_mut().entity_mut(body).insert(locked);
    let sheet = spawn_sheet(&mut app, Vec3::new(0.05, 0.2, 0.0));
    tick(&mut app, TO_BEGIN);
    throw(&mut app, sheet, Vec3::new(1.0, -2.0, 0.5));
    let (mut spin, mut speed) = (Vec3::ZERO, Vec3::ZERO);
    for _ in 0..48 {
        tick(&mut app, 1);
        let push = app.world().get::<ClothPush>(body).expect("a push");
        assert_eq!((push.velocity.y, push.angular_velocity.x), (0.0, 0.0));
        let transform = app.world().get::<Transform>(body).expect("a transform");
        assert_eq!(transform.translation.y, 0.0);
        spin = spin.max(push.angular_velocity.abs());
        speed = speed.max(push.velocity.abs());
    }
    assert!(spin.y > 0.0 && spin.z > 1.0e-3, "{spin}");
    assert!(speed.x > 1.0e-3 && speed.z > 0.0, "{speed}");
}

/// A body that is no cloth collider any more, while cloth touches it, keeps the velocity that it has.
#[test]
fn a_body_that_is_released_in_contact_is_not_pushed_on() {
    let mut app = app_with_rapier();
    let ball = spawn_ball(&mut app, 0.1, ClothPushBack);
    let sheet = spawn_sheet(&mut app, Vec3::Y * 0.2);
    tick(&mut app, TO_BEGIN);
    throw(&mut app, sheet, Vec3::NEG_Y * 2.0);
    let pushed = (0..32).any(|_| {
        tick(&mut app, 1);
        let push = app.world().get::<ClothPush>(ball);
        push.is_some_and(|push| *push != ClothPush::default())
    });
    assert!(pushed, "the sheet has struck it");
    app.world_mut()
        .entity_mut(ball)
        .remove::<RapierClothCollider>();
    let before = velocity(&app, ball);
    tick(&mut app, 20);
    let after = velocity(&app, ball);
    assert_eq!(before.linear, after.linear);
    // Rapier rounds an angular velocity as the body turns: by two roundings in each of 20 ticks.
    let most = 40.0 * f32::EPSILON * before.angular.length();
    assert!(before.angular.distance(after.angular) <= most);
    assert_eq!(
        app.world().get::<ClothPush>(ball),
        Some(&ClothPush::default())
    );
}
