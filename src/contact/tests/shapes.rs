//! How a point lies to each shape, and that none is left inside.

use bevy::math::Vec3;
use proptest::prelude::*;

use super::{
    ONLY, all_of, build, deepest_at, loose,
    random::{Random, cases},
};
use crate::{
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::MovingCollider,
    },
    solver::SubStep,
};

/// Of lengths up to 10 m: some twenty roundings of half an ε each, 20 × 6e-8 × 10 m.
const ROUNDING: f32 = 1.2e-5;

proptest! {
    #![proptest_config(cases(20_000))]

    /// Outside, the distance is that of the core in f64, and the way back leads to the surface; inside, the way out
    /// does, and no way out is shorter: a ball of that size is all inside.
    #[test]
    fn the_normal_leads_to_the_surface(seed in any::<u64>()) {
        let mut random = Random(seed);
        let shape = random.shape(2.0);
        let pose = random.pose(3.0);
        let point = Vec3::from(pose.translation) + random.within(3.0);
        let (core, radius) = shape.core(pose);
        let exact = |point: Vec3| core.distance(point) - f64::from(radius);
        let nearest = shape.nearest(pose, point);
        prop_assert!((nearest.normal.length() - 1.0).abs() < 1e-5);
        if nearest.distance > ROUNDING {
            let error = (f64::from(nearest.distance) - exact(point)).abs();
            prop_assert!(error < f64::from(ROUNDING), "{shape:?} {error}");
        } else {
            // Of a box, the core's distance is 0 all through it.
            prop_assert!(exact(point) <= f64::from(ROUNDING), "{shape:?}");
        }
        let surface = point - nearest.normal * nearest.distance;
        let left = shape.nearest(pose, surface).distance;
        prop_assert!(left.abs() < ROUNDING, "{shape:?} {left}");
        if nearest.distance < 0.0 {
            let inside = point + random.direction() * -nearest.distance * 0.999;
            prop_assert!(exact(inside) < f64::from(ROUNDING), "{shape:?}");
        }
    }
}

proptest! {
    #![proptest_config(cases(4_000))]

    /// Whatever the shape, its motion, its turn and the particles': none is inside when the sub-step ends. The exit
    /// lies on the surface but for roundings of lengths up to 10 m, and a swept one's depth is taken from where it was
    /// hit, so that only rounding is left of it, too. Friction is off: it may pull what left by another way than the
    /// nearest back in.
    #[test]
    fn none_is_left_inside(seed in any::<u64>(), is_moving in any::<bool>()) {
        let mut random = Random(seed);
        let shape = random.shape(1.0);
        let (travel, turn) = if is_moving { (4.0, 1.5) } else { (0.0, 0.0) };
        let collider = random.moving(shape, 1.0, travel, turn);
        let centre = Vec3::from(collider.from.translation);
        let positions: Vec<Vec3> = (0..24).map(|_| centre + random.within(1.5)).collect();
        let displacements: Vec<Vec3> =
            (0..24).map(|_| random.within(1.0) * random.part()).collect();
        let mut particles = loose(&positions, &displacements);
        let (surface, _) = build(24, 2, 0.1);
        let settings = ContactSettings {
            particle_radius: random.between(0.0, 0.1),
            narrow_phase: NarrowPhase::Particles,
            ..ContactSettings::default()
        };
        let mut detection = all_of(std::slice::from_ref(&collider), &settings, &surface, &particles);
        let substep = SubStep {
            index: 1,
            count: 3,
            ..ONLY
        };
        detection.respond(&mut particles, &settings, substep, |_| {});
        let deepest = deepest_at(&particles, &collider, substep.end(), settings.particle_radius);
        prop_assert!(deepest < f64::from(ROUNDING), "{collider:?} {deepest}");
    }

    /// With friction, what is pushed to the nearest surface moves along its tangent: still outside of all that is
    /// convex.
    #[test]
    fn friction_pulls_nothing_in(seed in any::<u64>()) {
        let mut random = Random(seed);
        let shape = random.shape(1.0);
        let pose = random.pose(1.0);
        let collider = MovingCollider::still(shape.clone(), pose);
        let mut positions = Vec::new();
        while positions.len() < 8 {
            let point = Vec3::from(pose.translation) + random.within(1.5);
            let depth = -shape.nearest(pose, point).distance;
            // None so deep that another side is chosen for it.
            if depth < shape.thickness() / 2.0 {
                positions.push(point);
            }
        }
        let displacements: Vec<Vec3> = (0..8).map(|_| random.within(0.3)).collect();
        let mut particles = loose(&positions, &displacements);
        let (surface, _) = build(8, 2, 0.1);
        let settings = ContactSettings {
            friction: random.between(0.0, 2.0),
            narrow_phase: NarrowPhase::Particles,
            ..ContactSettings::default()
        };
        let mut detection = all_of(std::slice::from_ref(&collider), &settings, &surface, &particles);
        detection.respond(&mut particles, &settings, ONLY, |_| {});
        let deepest = deepest_at(&particles, &collider, 1.0, 0.0);
        prop_assert!(deepest < f64::from(ROUNDING), "{collider:?} {deepest}");
    }
}
