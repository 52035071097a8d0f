//! A flag that hangs by its pole does not turn round it by itself.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A limp flag, an attached one and a sheet by one corner come to rest and sleep, whatever their sub-steps: the sweep's
/// own torque kept them turning for ever.
#[test]
fn what_hangs_by_a_line_comes_to_rest() {
    let material = ClothMaterial {
        damping: 0.05,
        ..default()
    };
    let corner = Pins::new([Pin::Corner(Corner::TopLeft)]);
    for (pins, substeps) in [
        (Pins::new([Pin::Column(0)]), 20),
        (Pins::new([Pin::Column(0)]), 10),
        (corner, 20),
    ] {
        let mut app = app();
        let cloth = (
            Cloth::new(24, 16, 0.06),
            pins,
            material,
            ClothSettings::substeps(substeps),
        );
        let cloth = app.world_mut().spawn(cloth).id();
        let asleep = (0..20).find(|_| {
            tick(&mut app, 64);
            stats(&app, cloth).is_asleep
        });
        assert!(asleep.is_some(), "{substeps} sub-steps");
    }
}

/// Turned on purpose, a flag without damping keeps its angular momentum about its pole: within a thousandth after two
/// seconds, as rounding is all that it loses.
#[test]
fn a_flag_that_is_turned_keeps_its_angular_momentum() {
    let mut app = app();
    let undamped = ClothMaterial {
        damping: 0.0,
        ..default()
    };
    let cloth = (
        Cloth::new(16, 12, 0.06),
        Pins::new([Pin::Column(0)]),
        undamped,
    );
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 64);
    change::<ClothParticles>(&mut app, cloth, |particles| {
        for index in 0..particles.len() {
            let at = particles.position(index).expect("a particle");
            let turning = Vec3::Y.cross(at) * 2.0;
            particles.set_velocity(index, turning).expect("a particle");
        }
    });
    let momentum = |app: &App| -> f32 {
        let particles = particles(app, cloth);
        let of = |index: usize| {
            let at = particles.position(index).expect("a particle");
            let velocity = particles.velocity(index).expect("a particle");
            let inverse_mass = particles.inverse_mass(index).expect("a particle");
            let mass = if inverse_mass > 0.0 {
                1.0 / inverse_mass
            } else {
                0.0
            };
            mass * Vec3::Y.dot(at.cross(velocity))
        };
        (0..particles.len()).map(of).sum()
    };
    let before = momentum(&app);
    tick(&mut app, 128);
    let after = momentum(&app);
    assert!(
        before > 0.0 && (after / before - 1.0).abs() < 1.0e-3,
        "{before} {after}"
    );
}

/// So does one that is attached, however uneven it began; and on a pole that goes up and down, or steadily along, it does
/// not circle: after it has swung out, it faces where it faced, but for what a damped swing of a metre may still be off.
#[test]
fn an_attached_flag_does_not_circle_its_pole() {
    let material = ClothMaterial {
        damping: 0.05,
        ..default()
    };
    for (name, speed) in [
        ("still", Vec3::ZERO),
        ("up and down", Vec3::Y * 0.003),
        ("along", Vec3::X * 0.2),
    ] {
        let mut app = app();
        let pole = app.world_mut().spawn(Transform::default()).id();
        let attached = ClothAttachments::new([(Pin::Column(0), pole)]);
        let cloth = Cloth {
            unevenness: 0.02,
            ..Cloth::new(24, 16, 0.06)
        };
        let cloth = (cloth, Pins::none(), attached, material);
        let cloth = app.world_mut().spawn(cloth).id();
        let mut ticks = 0;
        let mut run = |app: &mut App, seconds: u32| {
            for _ in 0..64 * seconds {
                ticks += 1;
                let phase = std::f32::consts::TAU * 0.5 * ticks as f32 * TICK;
                let way = match name {
                    "up and down" => phase.cos(),
                    _ => 1.0,
                };
                change::<Transform>(app, pole, |place| place.translation += speed * way * TICK);
                tick(app, 1);
            }
        };
        let heading = |app: &App| {
            let arm = position(app, cloth, (8, 23)) - position(app, cloth, (8, 0));
            arm.with_y(0.0).normalize()
        };
        run(&mut app, 20);
        let before = heading(&app);
        run(&mut app, 20);
        let turned = before.angle_between(heading(&app)).to_degrees();
        assert!(turned < 20.0, "{name}: {turned}°");
        assert_eq!(stats(&app, cloth).is_asleep, speed == Vec3::ZERO, "{name}");
    }
}
