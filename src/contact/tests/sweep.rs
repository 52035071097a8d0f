//! What passes a collider between two ends of sub-steps.

use bevy::math::Vec3;
use proptest::prelude::*;

use super::{
    ONLY, all_of, at, build, deepest_at, loose,
    random::{Random, cases},
};
use crate::contact::{
    candidates::{ContactSettings, NarrowPhase},
    colliders::{ColliderShape, MovingCollider},
    friction::first_touch,
};

/// One particle against one collider: where it ends, and its displacement.
fn meet(collider: &MovingCollider, place: Vec3, moved: Vec3, is_swept: bool) -> [Vec3; 2] {
    let mut particles = loose(&[place + moved, Vec3::splat(99.0)], &[moved]);
    let (surface, _) = build(2, 2, 0.1);
    let settings = ContactSettings {
        narrow_phase: NarrowPhase::Particles,
        is_swept,
        ..ContactSettings::default()
    };
    let mut detection = all_of(
        std::slice::from_ref(collider),
        &settings,
        &surface,
        &particles,
    );
    detection.respond(&mut particles, &settings, ONLY, |_| {});
    [
        particles.position(0).expect("it exists"),
        particles.displacement(0).expect("it exists"),
    ]
}

/// A particle that flies through a board in one sub-step stays in front of it; so does one that a board is swung
/// through. Without the sweep, neither is noticed.
#[test]
fn nothing_passes_a_thin_board() {
    let board = ColliderShape::Cuboid {
        half_size: Vec3::new(1.0, 1.0, 0.01),
    };
    let still = MovingCollider::still(board.clone(), at(Vec3::ZERO));
    let swung = MovingCollider {
        to: Vec3::Z * 2.0,
        ..MovingCollider::still(board, at(Vec3::NEG_Z))
    };
    let start = Vec3::new(0.2, 0.3, 1.0);
    let [end, moved] = meet(&still, start, Vec3::NEG_Z * 3.0, true);
    // Rounding of 3 m.
    assert!(end.distance(Vec3::new(0.2, 0.3, 0.01)) < 1e-6, "{end}");
    assert!((moved.z + 0.99).abs() < 1e-5, "as far as it went: {moved}");
    let [end, _] = meet(&still, start, Vec3::NEG_Z * 3.0, false);
    assert_eq!(end.z, -2.0);
    let [end, _] = meet(&swung, start, Vec3::ZERO, true);
    assert!((end.z - 2.01).abs() < 1e-6, "{end}");
    let [end, _] = meet(&swung, start, Vec3::ZERO, false);
    assert_eq!(end, start);
}

/// A half-turn of a rod in one sub-step takes what it meets along, by its own turn.
#[test]
fn a_turning_rod_takes_along_what_it_meets() {
    let rod = ColliderShape::Capsule {
        radius: 0.02,
        half_length: 1.0,
    };
    let turning = MovingCollider {
        turn: Vec3::Z * 1.0,
        ..MovingCollider::still(rod, at(Vec3::ZERO))
    };
    // Half a radian ahead of the rod's upper half.
    let start = Vec3::new(-0.5_f32.sin(), 0.5_f32.cos(), 0.0) * 0.8;
    let [end, _] = meet(&turning, start, Vec3::ZERO, true);
    let ahead = turning.shape.nearest(turning.pose_at(1.0), end);
    assert!(ahead.distance.abs() < 1e-5, "on its surface: {ahead:?}");
    let forward = turning.pose_at(1.0).rotation * Vec3::NEG_X;
    assert!(ahead.normal.dot(forward) > 0.99, "and ahead of it");
}

/// A first touch is no nearer than asked for but for roundings, and no farther than its tolerance.
#[test]
fn the_first_touch_is_at_the_distance_asked_for() {
    for (start, aside) in [(3.0_f32, 0.0_f32), (3.0, 0.5), (1.1, 0.9), (5.0, 0.1)] {
        let distance = |part: f32| (start - 10.0 * part).hypot(aside);
        let part = first_touch(10.0, 1.0, 1e-3, distance).expect("it meets");
        assert!(distance(part) <= 1.001 && distance(part) > 1.0 - 1e-5);
        assert!(start - 10.0 * part > 0.0, "on this side");
    }
    let never = |part: f32| (3.0 - 10.0 * part).hypot(1.5);
    assert_eq!(first_touch(10.0, 1.0, 1e-3, never), None);
    assert_eq!(first_touch(10.0, 1.0, 1e-3, |_| f32::NAN), None);
}

proptest! {
    #![proptest_config(cases(4_000))]

    /// Whatever is shot at the middle of a shape from outside ends not inside but for rounding of 10 m, and before a
    /// ball, not beyond.
    #[test]
    fn shots_end_in_front(seed in any::<u64>()) {
        let mut random = Random(seed);
        let kind = random.below(3);
        let shape = random.shape_of(kind, 0.5);
        let collider = MovingCollider::still(shape, random.pose(1.0));
        let centre = Vec3::from(collider.from.translation);
        let direction = random.direction();
        let start = centre - direction * random.between(1.5, 3.0);
        let [end, _] = meet(&collider, start, direction * random.between(3.0, 6.0), true);
        // Along a slanted face, it may slide past the middle.
        let is_before = (end - centre).dot(direction) < 0.0;
        prop_assert!(kind > 0 || is_before, "{collider:?} {start} {end}");
        let particles = loose(&[end], &[]);
        prop_assert!(deepest_at(&particles, &collider, 1.0, 0.0) < 1.2e-5);
    }
}
