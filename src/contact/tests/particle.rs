//! The push of particles by a ball, and Coulomb's law.

use std::f32::consts::FRAC_PI_2;

use bevy::math::{Isometry3d, Quat, Vec3};

use super::{ONLY, all_of, at, build, deepest_at, loose};
use crate::{
    cloth::{ClothParticles, Springs},
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::{ColliderShape, MovingCollider},
        detection::Detection,
    },
    solver::{Solver, SubStep, TickStep},
};

const GRAVITY: f32 = 9.81;

fn still() -> MovingCollider {
    MovingCollider::ball(1.0, Vec3::ZERO, Vec3::ZERO)
}

/// Detection of one collider with one candidate, particle 0.
fn first_against(
    collider: &MovingCollider,
    particles: &ClothParticles,
    narrow_phase: NarrowPhase,
) -> Detection {
    let (surface, _) = build(2, 2, 1.0);
    let mut detection = Detection::default();
    detection.begin(&surface, f32::INFINITY);
    detection.add(0, collider, narrow_phase, &[0], particles);
    detection
}

/// A particle on a ball of radius 1, `slope` radians from its top, without springs, after 0.1 s under
/// gravity: its angle from the top.
fn slide(slope: f32, friction: f32, ball: MovingCollider) -> f32 {
    let (_, mut particles) = build(2, 2, 1.0);
    particles
        .set_position(0, Vec3::new(slope.sin(), slope.cos(), 0.0))
        .expect("it exists");
    let step = TickStep {
        seconds: 0.1,
        substeps: 20,
        acceleration: Vec3::NEG_Y * GRAVITY,
        damping: 0.0,
        ..TickStep::default()
    };
    let settings = ContactSettings {
        friction,
        ..ContactSettings::default()
    };
    let mut detection = first_against(&ball, &particles, NarrowPhase::Particles);
    let mut solver = Solver::new(&Springs::default(), &particles);
    solver.advance(&mut particles, step, &[], |particles, substep| {
        detection.respond(particles, &settings, substep, |_| {})
    });
    let position = particles.position(0).expect("it exists");
    assert!(
        (position.length() - 1.0).abs() < 1e-6,
        "it lies on the surface"
    );
    position.x.atan2(position.y)
}

/// Below tan θ = μ it sticks; above it slides g (sin θ − μ cos θ) t²/2. The discrete formula falls short
/// of or exceeds that by t Δt/2 in t² (5 %), and over the slide of 1 to 3 cm the slope's change adds less
/// than 3 %.
#[test]
fn sticks_or_slips_by_coulombs_law() {
    for slope in [0.2_f32, 0.5, 0.8] {
        let stuck = slide(slope, slope.tan() * 1.02, still()) - slope;
        assert!(stuck.abs() < 1e-5, "{slope}: {stuck}");
        let friction = slope.tan() * 0.5;
        let slid = slide(slope, friction, still()) - slope;
        let expected = 0.5 * GRAVITY * (slope.sin() - friction * slope.cos()) * 0.01;
        assert!(
            (slid / expected - 1.0).abs() < 0.08,
            "{slope}: {slid} {expected}"
        );
    }
}

/// A ball that turns about z carries what sticks to it along: by its own angle.
#[test]
fn a_turning_ball_carries_what_sticks() {
    let turning = MovingCollider {
        turn: Vec3::new(0.0, 0.0, -0.02),
        ..still()
    };
    let carried = slide(0.0, 2.0, turning.clone());
    // The first sub-step's surface speed has to be gained from μ g Δt, which 0.02/0.1 rad/s is below
    // after three of the 20 sub-steps.
    assert!(carried > 0.017 && carried <= 0.0201, "{carried}");
    assert!(slide(0.0, 0.0, turning).abs() < 1e-6);
}

#[test]
fn pushes_out_exactly_and_leaves_pins_and_neighbours() {
    let (surface, mut particles) = build(3, 3, 1.0);
    particles.set_inverse_mass(0, 0.0).expect("it exists");
    // Its last sub-step of ten is slow, so that nothing is swept.
    let end = Vec3::new(0.5, -0.5, 0.4);
    let ball = MovingCollider::ball(1.0, end + Vec3::Z * 0.6, end);
    let before: Vec<Vec3> = particles.positions().collect();
    let settings = ContactSettings {
        particle_radius: 0.05,
        friction: 0.3,
        narrow_phase: NarrowPhase::Particles,
        ..ContactSettings::default()
    };
    let mut detection = all_of(std::slice::from_ref(&ball), &settings, &surface, &particles);
    let last = SubStep {
        index: 9,
        count: 10,
        farthest_move: 0.0,
    };
    assert!(detection.respond(&mut particles, &settings, last, |_| {}));
    let touch = &detection.touches()[0];
    let touched: Vec<u32> = detection
        .points(touch)
        .filter(|point| point.depth > 0.0)
        .map(|point| point.particle)
        .collect();
    assert_eq!(touched, [1, 3, 4]);
    let depth = 1.05 - end.distance(before[4]);
    assert!((touch.deepest - depth).abs() < 1e-6);
    assert!(deepest_at(&particles, &ball, 1.0, 0.05) < 1e-6);
    for index in [0, 2, 5, 6, 7, 8] {
        assert_eq!(particles.position(index), Some(before[index]));
    }
}

/// A ball that appears inside of a cloth moves it aside, and does not shoot it away.
#[test]
fn an_overlap_becomes_no_speed() {
    for (moving, left) in [
        // It was coming, and is stopped; it was leaving, and goes on.
        (Vec3::NEG_Y * 0.01, Vec3::ZERO),
        (Vec3::Y * 0.01, Vec3::Y * 0.01),
    ] {
        let mut particles = loose(&[Vec3::Y * 0.7], &[moving]);
        let mut detection = first_against(&still(), &particles, NarrowPhase::Particles);
        detection.respond(&mut particles, &ContactSettings::default(), ONLY, |_| {});
        assert_eq!(particles.position(0), Some(Vec3::Y));
        assert_eq!(particles.displacement(0), Some(left));
    }
}

#[test]
fn a_particle_in_the_centre_finds_a_way_out() {
    for shape in [
        ColliderShape::Ball { radius: 1.0 },
        ColliderShape::Capsule {
            radius: 1.0,
            half_length: 0.0,
        },
        ColliderShape::Cuboid {
            half_size: Vec3::new(1.0, 2.0, 3.0),
        },
    ] {
        let mut particles = loose(&[Vec3::ZERO], &[]);
        let collider = MovingCollider::still(shape.clone(), at(Vec3::ZERO));
        let mut detection = first_against(&collider, &particles, NarrowPhase::Particles);
        let settings = ContactSettings {
            friction: 0.5,
            ..ContactSettings::default()
        };
        detection.respond(&mut particles, &settings, ONLY, |_| {});
        let moved = particles.position(0).expect("it exists").length();
        assert!((moved - 1.0).abs() < 1e-6, "{shape:?}: {moved}");
    }
}

/// Two overlapping balls push a particle one after the other, in the order of their numbers, whichever was found
/// first.
#[test]
fn colliders_push_in_the_order_of_their_numbers() {
    let balls = [-0.4_f32, 0.4].map(|x| MovingCollider::ball(1.0, Vec3::X * x, Vec3::X * x));
    let ends = [[0, 1], [1, 0]].map(|order| {
        let mut particles = loose(&[Vec3::Y * 0.5], &[]);
        let (surface, _) = build(2, 2, 1.0);
        let mut detection = Detection::default();
        detection.begin(&surface, 1.0);
        for id in order {
            detection.add(id, &balls[id], NarrowPhase::Particles, &[0], &particles);
        }
        detection.respond(&mut particles, &ContactSettings::default(), ONLY, |_| {});
        particles.position(0).expect("it exists")
    });
    assert_eq!(ends[0], ends[1]);
    assert!((ends[0].distance(Vec3::X * 0.4) - 1.0).abs() < 1e-6);
}

/// Layers of cloth push particles onto a collider in a sub-step, after they were seen to be far away from it.
#[test]
fn what_else_pushes_particles_onto_a_collider_is_noted() {
    for narrow_phase in [NarrowPhase::Particles, NarrowPhase::Triangles] {
        let (surface, mut particles) = build(9, 9, 0.1);
        // The sheet is in the plane z = 0; the half-space is all that is 5 cm and more behind it.
        let pose = Isometry3d::new(Vec3::NEG_Z * 0.05, Quat::from_rotation_x(FRAC_PI_2));
        let wall = MovingCollider::still(ColliderShape::HalfSpace, pose);
        let settings = ContactSettings {
            narrow_phase,
            ..ContactSettings::default()
        };
        let mut detection = all_of(std::slice::from_ref(&wall), &settings, &surface, &particles);
        let substep = |index| SubStep {
            index,
            count: 4,
            farthest_move: 0.0,
        };
        assert!(!detection.respond(&mut particles, &settings, substep(0), |_| {}));
        for index in 0..particles.len() {
            let behind = particles.position(index).expect("it exists") + Vec3::NEG_Z * 0.06;
            particles.set_position(index, behind).expect("it exists");
        }
        detection.note_push(0.06);
        assert!(
            detection.respond(&mut particles, &settings, substep(1), |_| {}),
            "{narrow_phase:?}"
        );
    }
}
