//! The push of triangles.

use bevy::math::Vec3;
use proptest::prelude::*;

use super::{
    ONLY, all_of, build,
    random::{Random, cases},
};
use crate::{
    cloth::{ClothParticles, Surface},
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::{MovingCollider, nearest},
    },
};

const SPACING: f32 = 0.1;

fn triangles(particles: &ClothParticles, surface: &Surface) -> Vec<[Vec3; 3]> {
    let place = |index: u32| particles.position(index as usize).expect("it exists");
    surface
        .triangles()
        .iter()
        .map(|corners| corners.map(place))
        .collect()
}

fn settings() -> ContactSettings {
    ContactSettings {
        narrow_phase: NarrowPhase::Triangles,
        ..ContactSettings::default()
    }
}

proptest! {
    #![proptest_config(cases(3_000))]

    /// A ball between the particles, smaller than a cell: no triangle of the cell is nearer than its reach, but for
    /// what the second triangle's push along its own normal takes of the first one's, whose normal is turned against
    /// it by the dent that the first push made. On a line through the diagonal's middle there is none; elsewhere a
    /// push of depth d tilts the other triangle by less than d/h, its height h = 0.7 spacings, which takes less than
    /// d²/h along the normal. And the sum of mass × displacement is along the ball's way, as masses are equal.
    #[test]
    fn a_small_ball_dents_a_cell(
        x in 0.3_f32..0.7, y in 0.3_f32..0.7, height in 0.05_f32..0.25, is_below in any::<bool>(),
    ) {
        let (surface, mut particles) = build(2, 2, SPACING);
        let sign = if is_below { -1.0 } else { 1.0 };
        let centre = Vec3::new(x, -y, sign * height) * SPACING;
        let radius = 0.3 * SPACING;
        let ball = MovingCollider::ball(radius, centre, centre);
        let settings = ContactSettings { particle_radius: 0.001, ..settings() };
        let before: Vec<Vec3> = particles.positions().collect();
        let mut detection = all_of(std::slice::from_ref(&ball), &settings, &surface, &particles);
        detection.respond(&mut particles, &settings, ONLY, |_| {});
        let reach = radius + 0.001;
        let depth = reach - height * SPACING;
        let tolerance = depth * depth / (0.7 * SPACING) + 1e-6;
        for triangle in triangles(&particles, &surface) {
            let distance = nearest(triangle, [centre; 2]).offset.length();
            prop_assert!(distance > reach - tolerance, "{} of {reach}", distance);
        }
        // On the diagonal both are as deep, and the first push takes the second one along.
        prop_assert!(detection.touches()[0].deepest < depth + 1e-6);
        let moved: Vec3 = particles.positions().zip(before).map(|(after, before)| after - before).sum();
        prop_assert!(moved.z * sign < 0.0, "away from the ball");
        for displacement in particles.displacements() {
            prop_assert_eq!(displacement, Vec3::ZERO, "an overlap becomes no speed");
        }
    }

    /// A ball that comes down on the inside of one triangle: all corners are pushed along its way, none beside it, so
    /// momentum goes along the normal.
    #[test]
    fn momentum_goes_along_the_normal(u in 0.2_f32..0.4, v in 0.2_f32..0.4, seed in any::<u64>()) {
        let (surface, mut particles) = build(2, 2, SPACING);
        let mut random = Random(seed);
        let index = 3;
        // The other triangle out of the way.
        particles.set_position(index, Vec3::new(1.0, -1.0, 5.0)).expect("it exists");
        for index in 0..4 {
            particles.set_inverse_mass(index, 1.0).expect("it exists");
            let sideways = random.within(0.002).with_z(0.02);
            particles.set_displacement(index, sideways).expect("it exists");
        }
        let before: Vec<Vec3> = particles.displacements().collect();
        let centre = Vec3::new(u, -v, 0.1) * SPACING;
        let ball = MovingCollider::ball(0.15 * SPACING, centre, centre);
        let settings = ContactSettings { is_swept: false, ..settings() };
        let mut detection = all_of(std::slice::from_ref(&ball), &settings, &surface, &particles);
        let is_moved = detection.respond(&mut particles, &settings, ONLY, |_| {});
        prop_assert!(is_moved);
        let gained: Vec3 = particles.displacements().zip(before).map(|(a, b)| a - b).sum();
        // A rounding of each of four displacements of 0.02 m.
        prop_assert!(gained.truncate().length() < 1e-8 + 1e-5 * gained.z.abs(), "{gained}");
        prop_assert!(gained.z < 0.0);
    }
}

/// With its corners held, a triangle stays; with one free, that one takes all of the push.
#[test]
fn pinned_corners_hold() {
    let centre = Vec3::new(0.25, -0.25, 0.1) * SPACING;
    let ball = MovingCollider::ball(0.3 * SPACING, centre, centre);
    for free in [None, Some(0)] {
        let (surface, mut particles) = build(2, 2, SPACING);
        for index in 0..4 {
            if Some(index) != free {
                particles.set_inverse_mass(index, 0.0).expect("it exists");
            }
        }
        let before: Vec<Vec3> = particles.positions().collect();
        let mut detection = all_of(
            std::slice::from_ref(&ball),
            &settings(),
            &surface,
            &particles,
        );
        let moved = detection.respond(&mut particles, &settings(), ONLY, |_| {});
        assert_eq!(moved, free.is_some());
        for (index, before) in before.into_iter().enumerate() {
            let stays = particles.position(index) == Some(before);
            assert_eq!(stays, Some(index) != free, "{index}");
        }
    }
}
