//! Bodies that cloth pushes back.

use bevy::{math::DVec3, prelude::*};
use bevy_drape::prelude::*;

use crate::support::*;

/// A body of a test: what a physics engine would know of it.
#[derive(Component, Default, Clone, Copy)]
struct Body {
    velocity: Vec3,
    spin: Vec3,
    gravity: f32,
}

/// An app that moves bodies as an engine does: by their velocities, which the cloth's pushes change.
fn app_with_bodies() -> App {
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

fn place(app: &App, body: Entity) -> Vec3 {
    let transform = app.world().get::<Transform>(body).expect("a transform");
    transform.translation
}

fn velocity(app: &App, body: Entity) -> Vec3 {
    app.world().get::<Body>(body).expect("a body").velocity
}

fn flat(x: f32, y: f32, z: f32) -> Transform {
    Transform::from_xyz(x, y, z).with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2))
}

/// A sheet of 1 m that is held by two opposite edges or by all four, level at the height 0.
fn spawn_held(app: &mut App, particles: u32, all_edges: bool) -> Entity {
    let spacing = 1.0 / (particles - 1) as f32;
    let last = particles - 1;
    let pins = if all_edges {
        Pins::filter(move |row, column| row == 0 || row == last || column == 0 || column == last)
    } else {
        Pins::filter(move |_, column| column == 0 || column == last)
    };
    let sheet = Cloth::new(particles, particles, spacing).centred();
    let sheet = (sheet, pins, flat(0.0, 0.0, 0.0));
    app.world_mut().spawn(sheet).id()
}

fn spawn_ball(app: &mut App, mass: f32, radius: f32, place: Vec3) -> Entity {
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
fn cloth_energy(app: &App, cloth: Entity) -> f64 {
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

/// Dropped from 0.2 m, a ball of any mass comes to rest in what holds it, and stays there without a jitter.
#[test]
fn a_ball_rests_on_what_holds_it() {
    for (mass, particles, all_edges) in [
        (0.2, 17, false),
        (0.2, 17, true),
        (0.02, 17, true),
        (2.0, 17, false),
        (0.2, 33, true),
    ] {
        let mut app = app_with_bodies();
        let sheet = spawn_held(&mut app, particles, all_edges);
        let radius = 0.15;
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
            highest = highest.max(energy + cloth_energy(&app, sheet) - start);
            if count >= 50 * 64 {
                (low, high) = (low.min(place), high.max(place));
                fastest = fastest.max(velocity.length());
            }
        }
        println!(
            "{mass} {particles} {all_edges}: rest {:?} range {:?} speed {fastest} gain {highest}",
            high,
            high - low
        );
    }
}

/// A roller lies across a strip that is held at its ends: where, its weight, the strip's length and what the strip gives say.
///
/// From the pin at the distance a from the middle, the strip goes down straight at the angle θ, then around the roller: with
/// half of its length l = t + Rθ, a = t cos θ + R sin θ. Its tension is T = W/(2 sin θ), and l = l₀ (1 + T α/(n h)) for n
/// threads of springs of length h and compliance α.
#[test]
fn a_roller_sags_a_strip_by_its_weight() {
    for (mass, compliance, slack) in [
        (2.0, 0.0, 1.1),
        (20.0, 0.0, 1.1),
        (2.0, 2.0e-4, 1.0),
        (20.0, 2.0e-4, 1.0),
    ] {
        let mut app = app_with_bodies();
        let (columns, rows, spacing) = (61_u32, 5_u32, 0.02_f32);
        let half = 0.5 * (columns - 1) as f32 * spacing;
        let a = half / slack;
        let pins = Pins::filter(move |_, column| column == 0 || column == columns - 1);
        let material = ClothMaterial {
            stretch_compliance: compliance,
            shear_compliance: 1.0,
            bend_rigidity: 0.0,
            friction: 0.0,
            areal_density: 0.05,
            ..ClothMaterial::COTTON
        };
        let strip = Cloth::new(columns, rows, spacing).centred();
        let strip = (strip, pins, material, flat(0.0, 0.0, 0.0));
        let strip = app.world_mut().spawn(strip).id();
        tick(&mut app, 1);
        change::<ClothParticles>(&mut app, strip, |particles| {
            for row in 0..rows {
                for column in [0, columns - 1] {
                    let mut place = particles.position((row, column)).expect("it exists");
                    place.x = a.copysign(place.x);
                    particles
                        .set_position((row, column), place)
                        .expect("it exists");
                }
            }
        });
        let radius = 0.1;
        let roller = (
            ClothCollider::capsule(radius, 0.6),
            ClothBody::new(mass, Vec3::INFINITY),
            Body {
                gravity: GRAVITY,
                ..default()
            },
            Transform::from_xyz(0.0, radius + 0.05, 0.0)
                .with_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)),
        );
        let roller = app.world_mut().spawn(roller).id();
        tick(&mut app, 60 * 64);
        let settings = ClothSettings::default();
        let reach = f64::from(radius + settings.particle_radius);
        let (a, l0) = (f64::from(a), f64::from(half));
        let load = f64::from(mass * GRAVITY);
        // A longer half by the tension; θ by bisection.
        let half_span = |theta: f64| {
            let tension = load / (2.0 * theta.sin());
            let l = l0
                * (1.0 + tension * f64::from(compliance) / (f64::from(rows) * f64::from(spacing)));
            (l - reach * theta) * theta.cos() + reach * theta.sin()
        };
        let (mut low, mut high) = (1.0e-4_f64, 1.5);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            // The steeper, the shorter.
            if half_span(middle) > a {
                low = middle
            } else {
                high = middle
            }
        }
        let theta = low;
        let t = (a - reach * theta.sin()) / theta.cos();
        let depth = t * theta.sin() + reach * (1.0 - theta.cos());
        let height = reach - depth;
        println!(
            "{mass} {compliance}: theta {theta} expected {height} got {} v {}",
            place(&app, roller),
            velocity(&app, roller)
        );
    }
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
        let under = place(&app, ball);
        println!(
            "{mass} of {cloth_mass}: fastest {fastest} momentum off {worst} gain {gain} of {start} ball {under} mid {}",
            position(&app, sheet, (8, 8)).z + 0.3
        );
    }
}

/// Momentum of a cloth in the world, and its mass (kg·m/s, kg).
fn cloth_momentum(app: &App, cloth: Entity) -> (DVec3, f64) {
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
        println!(
            "{narrow_phase:?} {friction}: worst {worst} of {gravity} = {:.2e}, on the ball {on_ball}",
            worst / gravity
        );
        assert!(on_ball > 10, "{on_ball}");
    }
}
