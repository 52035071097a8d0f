//! Bodies that cloth pushes back.

use bevy::{math::DVec3, prelude::*};
use bevy_drape::prelude::*;

use crate::support::*;

/// A body of a test: what a physics engine would know of it.
#[derive(Component, Default, Clone, Copy)]
pub struct Body {
    pub velocity: Vec3,
    pub spin: Vec3,
    pub gravity: f32,
}

/// An app that moves bodies as an engine does: by their velocities, which the cloth's pushes change.
pub fn app_with_bodies() -> App {
    let mut app = app();
    app.add_systems(
        FixedUpdate,
        (
            (|mut bodies: Query<(&mut Body, &mut Transform)>, time: Res<Time>| {
                let dt = time.delta_secs();
                for (mut body, mut transform) in &mut bodies {
                    body.velocity.y -= body.gravity * dt;
                    transform.translation += body.velocity * dt;
                    let turn = Quat::from_scaled_axis(body.spin * dt);
                    transform.rotation = (turn * transform.rotation).normalize();
                }
            })
            .before(ClothSystems::Prepare),
            (|mut bodies: Query<(&mut Body, &ClothPush)>| {
                for (mut body, push) in &mut bodies {
                    body.velocity += push.velocity;
                    body.spin += push.angular_velocity;
                }
            })
            .after(ClothSystems::WriteBack),
        ),
    );
    app
}

pub fn place(app: &App, body: Entity) -> Vec3 {
    let transform = app.world().get::<Transform>(body).expect("a transform");
    transform.translation
}

pub fn velocity(app: &App, body: Entity) -> Vec3 {
    app.world().get::<Body>(body).expect("a body").velocity
}

pub fn flat(x: f32, y: f32, z: f32) -> Transform {
    Transform::from_xyz(x, y, z).with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2))
}

/// A sheet of 1 m that is held by its four edges, level at the height 0.
pub fn spawn_trampoline(app: &mut App, particles: u32) -> Entity {
    let spacing = 1.0 / (particles - 1) as f32;
    let last = particles - 1;
    let pins =
        Pins::filter(move |row, column| row == 0 || row == last || column == 0 || column == last);
    let sheet = Cloth::new(particles, particles, spacing).centred();
    let sheet = (sheet, pins, flat(0.0, 0.0, 0.0));
    app.world_mut().spawn(sheet).id()
}

pub fn spawn_ball(app: &mut App, mass: f32, radius: f32, place: Vec3) -> Entity {
    let ball = (
        ClothCollider::ball(radius),
        ClothBody::ball(mass, radius),
        Body {
            gravity: GRAVITY,
            ..default()
        },
        Transform::from_translation(place),
    );
    app.world_mut().spawn(ball).id()
}

/// Kinetic energy of a cloth, and its energy of height (J).
pub fn cloth_energy(app: &App, cloth: Entity) -> f64 {
    let particles = particles(app, cloth);
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let each = (0..particles.len()).filter_map(|index| {
        let inverse_mass = f64::from(particles.inverse_mass(index)?);
        let velocity = particles.velocity(index)?.as_dvec3();
        let height = f64::from(frame.to_world(particles.position(index)?).y);
        (inverse_mass > 0.0)
            .then(|| (velocity.length_squared() / 2.0 + f64::from(GRAVITY) * height) / inverse_mass)
    });
    each.sum()
}

/// Dropped from 0.2 m onto a trampoline, a light ball comes to rest: a minute later nothing but its roll is left, and at no time
/// had ball and cloth more energy than the ball began with.
#[test]
fn a_ball_rests_on_a_trampoline() {
    let mut app = app_with_bodies();
    let sheet = spawn_trampoline(&mut app, 33);
    let (mass, radius) = (0.2_f32, 0.15);
    let ball = spawn_ball(&mut app, mass, radius, Vec3::new(0.02, radius + 0.2, 0.01));
    let start = f64::from(mass * GRAVITY * (radius + 0.2));
    let mut highest = f64::MIN;
    let (mut low, mut high) = (Vec3::MAX, Vec3::MIN);
    let mut fastest = 0.0_f32;
    for count in 0..60 * 64 {
        tick(&mut app, 1);
        let (place, velocity) = (place(&app, ball), velocity(&app, ball));
        let energy = f64::from(mass)
            * (f64::from(velocity.length_squared()) / 2.0 + f64::from(GRAVITY * place.y));
        highest = highest.max(energy + cloth_energy(&app, sheet));
        if count >= 50 * 64 {
            (low, high) = (low.min(place), high.max(place));
            fastest = fastest.max(velocity.length());
        }
    }
    assert!(highest < start, "{highest} J of {start}");
    let range = high - low;
    // Nothing slows the roll of a ball but the cloth's own damping.
    assert!(range.y < 1.0e-4 && range.length() < 1.0e-3, "{range}");
    assert!(
        low.y > 0.5 * radius && high.y < radius + 0.02,
        "{low} to {high}"
    );
    // What the engine's gravity gives in one go, the cloth takes back in the course of the tick: half of it is seen.
    assert!(fastest < 0.6 * GRAVITY * TICK, "{fastest} m/s");
}

/// A heavy sheet that falls flat on a light ball in free fall takes it along: the ball is neither passed nor shot away.
#[test]
fn a_light_ball_is_taken_along() {
    for mass in [0.001_f32, 0.01, 0.1, 1.0] {
        let mut app = app_with_bodies();
        let material = ClothMaterial {
            areal_density: 2.0,
            damping: 0.0,
            ..ClothMaterial::COTTON
        };
        let sheet = (
            Cloth::new(17, 17, 0.0625).centred(),
            Pins::none(),
            material,
            ClothSettings {
                gravity: Some(Vec3::ZERO),
                ..default()
            },
            flat(0.0, 0.3, 0.0),
        );
        let sheet = app.world_mut().spawn(sheet).id();
        let radius = 0.15;
        let ball = spawn_ball(&mut app, mass, radius, Vec3::ZERO);
        change::<Body>(&mut app, ball, |body| body.gravity = 0.0);
        tick(&mut app, 1);
        change::<ClothParticles>(&mut app, sheet, |particles| {
            for index in 0..particles.len() {
                // The sheet's own z is the world's y.
                particles
                    .set_velocity(index, Vec3::NEG_Z * 2.0)
                    .expect("it exists");
            }
        });
        let cloth_mass: f64 = particles(&app, sheet)
            .inverse_masses()
            .map(|w| 1.0 / f64::from(w))
            .sum();
        let mut fastest = 0.0_f32;
        let mut worst = 0.0_f64;
        let energy = |app: &App| {
            let particles = particles(app, sheet);
            (0..particles.len())
                .map(|i| {
                    let w = f64::from(particles.inverse_mass(i).expect("a mass"));
                    particles
                        .velocity(i)
                        .expect("a velocity")
                        .as_dvec3()
                        .length_squared()
                        / (2.0 * w)
                })
                .sum::<f64>()
        };
        let start = energy(&app);
        let mut gain = f64::MIN;
        for _ in 0..64 {
            tick(&mut app, 1);
            fastest = fastest.max(-velocity(&app, ball).y);
            let momentum: f64 = {
                let particles = particles(&app, sheet);
                (0..particles.len())
                    .map(|i| {
                        f64::from(particles.velocity(i).expect("a velocity").z)
                            / f64::from(particles.inverse_mass(i).expect("a mass"))
                    })
                    .sum()
            };
            let total = momentum + f64::from(mass * velocity(&app, ball).y);
            worst = worst.max((total + 2.0 * cloth_mass).abs() / (2.0 * cloth_mass));
            let ball_energy = f64::from(mass * velocity(&app, ball).length_squared() / 2.0);
            gain = gain.max(energy(&app) + ball_energy - start);
        }
        // Positions and velocities are floats: a part in 10⁷, some dozen times a tick.
        assert!(worst < 1.0e-5, "{mass} kg: momentum is off by {worst}");
        assert!(gain < 1.0e-6 * start, "{mass} kg: {gain} J of {start}");
        // It is as fast as the sheet that carries it, which rings: no faster by a tenth.
        assert!(fastest < 2.2, "{mass} kg: {fastest} m/s");
        // What two bodies of these masses have in common after an impact without a bounce is less than the ball has.
        let common = 2.0 * cloth_mass / (cloth_mass + f64::from(mass));
        assert!(
            f64::from(fastest) > 0.5 * common,
            "{mass} kg: {fastest} m/s"
        );
        let sheet_height = position(&app, sheet, (8, 8)).z + 0.3;
        assert!(
            place(&app, ball).y + radius < sheet_height + 0.01,
            "{mass} kg: the ball is below the sheet"
        );
    }
}

/// Momentum of a cloth in the world, and its mass (kg·m/s, kg).
pub fn cloth_momentum(app: &App, cloth: Entity) -> (DVec3, f64) {
    let particles = particles(app, cloth);
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let rotation = frame.isometry().rotation.as_dquat();
    let (mut momentum, mut mass) = (DVec3::ZERO, 0.0);
    for index in 0..particles.len() {
        let inverse_mass = f64::from(particles.inverse_mass(index).expect("it exists"));
        let velocity = particles.velocity(index).expect("it exists");
        momentum += rotation * velocity.as_dvec3() / inverse_mass;
        mass += 1.0 / inverse_mass;
    }
    (momentum, mass)
}

/// What gravity gives to a cloth that no pin holds, and what it gives to what it lies on and slides over, is its momentum: over a
/// minute, to a part in ten thousand of what gravity gave.
#[test]
fn what_a_cloth_gives_it_has_lost() {
    for (narrow_phase, friction, radius) in [
        (NarrowPhase::Particles, 0.4, 0.5),
        (NarrowPhase::Particles, 0.05, 0.5),
        (NarrowPhase::Triangles, 0.4, 0.3),
    ] {
        let mut app = app();
        let material = ClothMaterial {
            damping: 0.0,
            friction,
            ..ClothMaterial::COTTON
        };
        let settings = ClothSettings {
            sleeps: false,
            ..default()
        };
        let sheet = Cloth::new(17, 17, 0.08).lying().centred();
        let place =
            Transform::from_xyz(0.05, radius + 0.1, 0.02).with_rotation(Quat::from_rotation_y(0.4));
        let sheet = (sheet, Pins::none(), material, settings, narrow_phase, place);
        let sheet = app.world_mut().spawn(sheet).id();
        let ball = app.world_mut().spawn(ClothCollider::ball(radius)).id();
        // What slides off lands on a tilted plane.
        let ground = Transform::from_xyz(0.0, -1.5, 0.0).with_rotation(Quat::from_rotation_z(0.1));
        app.world_mut().spawn((ClothCollider::plane(), ground));
        tick(&mut app, 1);
        let (start, mass) = cloth_momentum(&app, sheet);
        let mut given = DVec3::ZERO;
        let (mut worst, mut on_ball) = (0.0_f64, 0);
        for count in 1..60 * 64 {
            tick(&mut app, 1);
            let contacts = app.world().get::<ClothContacts>(sheet).expect("contacts");
            given += contacts
                .iter()
                .map(|contact| contact.impulse.as_dvec3())
                .sum::<DVec3>();
            on_ball += usize::from(contacts.with(ball).is_some());
            let (momentum, _) = cloth_momentum(&app, sheet);
            let fall =
                DVec3::NEG_Y * mass * f64::from(GRAVITY) * f64::from(TICK) * f64::from(count);
            worst = worst.max((start + fall - given - momentum).length());
        }
        let gravity = mass * f64::from(GRAVITY) * 60.0;
        assert!(
            worst < 1.0e-4 * gravity,
            "{narrow_phase:?}, μ {friction}: {worst} of {gravity} N·s"
        );
        assert!(on_ball > 10, "{on_ball}");
    }
}
