//! Colliders that give way, against the laws of impact.

use bevy::math::{Isometry3d, Mat3, Quat, Vec3};

use super::{all_of, build};
use crate::{
    cloth::ClothParticles,
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::{BodyMass, ColliderShape, MovingCollider},
    },
    solver::SubStep,
};

const SECONDS: f32 = 1.0e-3;

const SETTINGS: ContactSettings = ContactSettings {
    particle_radius: 0.01,
    friction: 0.0,
    narrow_phase: NarrowPhase::Particles,
    is_swept: true,
};

/// Nine particles that lie level, 1 mm deep in what is below the height 0, and have come down by 2 mm.
fn level() -> (std::sync::Arc<crate::cloth::Surface>, ClothParticles, f64) {
    let (surface, mut particles) = build(3, 3, 0.1);
    particles.set_substep(SECONDS);
    let mut mass = 0.0;
    for index in 0..9 {
        let place = Vec3::new((index % 3) as f32 - 1.0, 0.0, (index / 3) as f32 - 1.0) * 0.1;
        particles
            .set_position(index, place + Vec3::Y * 0.009)
            .expect("it exists");
        particles
            .set_displacement(index, Vec3::NEG_Y * 0.002)
            .expect("it exists");
        mass += 1.0 / f64::from(particles.inverse_mass(index).expect("it exists"));
    }
    (surface, particles, mass)
}

fn table(mass: f32, inverse_inertia: Mat3) -> MovingCollider {
    let shape = ColliderShape::Cuboid {
        half_size: Vec3::new(1.0, 0.5, 1.0),
    };
    let pose = Isometry3d::from_translation(Vec3::NEG_Y * 0.5);
    MovingCollider {
        body: Some(BodyMass {
            inverse_mass: mass.recip(),
            inverse_inertia,
            centre: Vec3::ZERO,
            free: Mat3::IDENTITY,
            is_settled: false,
        }),
        ..MovingCollider::still(shape, pose)
    }
}

/// A table of any mass and the particles that fall flat on it go on with one velocity, which momentum says, and touch.
#[test]
fn an_impact_shares_by_mass() {
    for ratio in [0.001_f64, 0.1, 1.0, 10.0, 1000.0] {
        let (surface, mut particles, mass) = level();
        let body = table((ratio * mass) as f32, Mat3::IDENTITY);
        let mut detection = all_of(&[body], &SETTINGS, &surface, &particles);
        let substep = SubStep {
            index: 1,
            count: 4,
            farthest_move: 0.002,
        };
        assert!(detection.respond(&mut particles, &SETTINGS, substep, |_| {}));
        let change = detection.body_change(0).expect("it was touched");
        let touch = &detection.touches()[0];
        let moving = touch.collider.clone();
        let top = moving.pose_at(substep.end()).translation.y + 0.5;
        for index in 0..9 {
            let position = particles.position(index).expect("it exists");
            let moved = f64::from(particles.velocity(index).expect("it exists").y);
            assert!(
                (position.y - top - 0.01).abs() < 1e-6,
                "{ratio}: {position} on {top}"
            );
            let body_velocity = f64::from(change.velocity.y);
            let momentum = mass * moved + ratio * mass * body_velocity;
            let before = -mass * 0.002 / f64::from(SECONDS);
            assert!(
                (momentum / before - 1.0).abs() < 1e-5,
                "{ratio}: {momentum} {before}"
            );
            let given = f64::from(touch.impulse.y);
            assert!(
                (given - ratio * mass * body_velocity).abs() < 1e-5 * before.abs(),
                "{ratio}"
            );
        }
        // Straight on from there.
        let rest = moving.pose_at(1.0).translation.y - moving.pose_at(substep.end()).translation.y;
        let expected = change.velocity.y * SECONDS * 2.0;
        assert!(
            (rest - expected).abs() < 1e-6 * (1.0 + expected.abs()),
            "{rest} {expected}"
        );
        assert!(change.angular_velocity.length() < 1e-4 * change.velocity.length());
    }
}

/// Particles that strike a table beside its middle turn it, as much as its inertia lets them; kinetic energy does not grow.
#[test]
fn an_impact_beside_the_middle_turns() {
    let (surface, mut particles, mass) = level();
    for index in 0..9 {
        let place = particles.position(index).expect("it exists");
        particles
            .set_position(index, place + Vec3::X * 0.5)
            .expect("it exists");
    }
    let (table_mass, inertia) = (mass as f32, 0.3 * mass as f32);
    let body = table(
        table_mass,
        Mat3::from_diagonal(Vec3::splat(inertia.recip())),
    );
    let mut detection = all_of(&[body], &SETTINGS, &surface, &particles);
    let substep = SubStep {
        index: 0,
        count: 1,
        farthest_move: 0.002,
    };
    assert!(detection.respond(&mut particles, &SETTINGS, substep, |_| {}));
    let change = detection.body_change(0).expect("it was touched");
    // What is pushed down at +x turns it about −z.
    assert!(change.velocity.y < 0.0 && change.angular_velocity.z < 0.0);
    let (push, turn) = (
        table_mass * change.velocity,
        inertia * change.angular_velocity,
    );
    let arm = Vec3::new(0.5, 0.5, 0.0);
    // The particles' middle, 10 mm above the table: the arm of all that they gave.
    let expected = arm.cross(push);
    assert!(
        turn.distance(expected) < 0.03 * turn.length(),
        "{turn} {expected}"
    );
    let moving: f32 = (0..9)
        .map(|index| {
            let velocity = particles.velocity(index).expect("it exists");
            velocity.length_squared() / particles.inverse_mass(index).expect("it exists")
        })
        .sum();
    let body_energy = table_mass * change.velocity.length_squared()
        + inertia * change.angular_velocity.length_squared();
    let before = mass as f32 * (0.002_f32 / SECONDS).powi(2);
    assert!(
        moving + body_energy < before,
        "{moving} + {body_energy} of {before}"
    );
}

/// Seen from a frame that is turned, the same body is as hard to move.
#[test]
fn a_mass_turns_with_its_frame() {
    let mass = BodyMass {
        inverse_mass: 2.0,
        inverse_inertia: Mat3::from_diagonal(Vec3::new(1.0, 2.0, 3.0)),
        centre: Vec3::X,
        free: Mat3::from_diagonal(Vec3::new(1.0, 0.0, 0.0)),
        is_settled: true,
    };
    let turned = mass.turned(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    assert!(turned.centre.distance(Vec3::Y) < 1e-6);
    let spun = turned.inverse_inertia * Vec3::Y;
    assert!(spun.distance(Vec3::Y) < 1e-6, "what was x is y: {spun}");
    let moved = turned.free * Vec3::ONE;
    assert!(
        moved.distance(Vec3::Y) < 1e-6,
        "it goes along what was x: {moved}"
    );
    let halved = mass.part_of(2);
    assert_eq!(halved.inverse_mass, 4.0);
    assert_eq!(halved.inverse_inertia * Vec3::X, Vec3::X * 2.0);
}
