//! That what is searched for is all that a collider passes.

use bevy::math::{Vec3, bounding::BoundingSphere};
use proptest::prelude::*;

use super::random::{Random, cases};
use crate::contact::colliders::{ColliderShape, MovingCollider};

/// Some point inside of a collider when a part of the tick has passed, that is no farther than `beyond` (m) from its
/// origin.
fn inside(random: &mut Random, collider: &MovingCollider, part: f32, beyond: f32) -> Vec3 {
    let local = match collider.shape {
        ColliderShape::Ball { radius } => random.direction() * radius * random.part().sqrt(),
        ColliderShape::Capsule {
            radius,
            half_length,
        } => {
            let along = Vec3::Y * random.between(-half_length, half_length);
            along + random.direction() * radius * random.part().sqrt()
        }
        ColliderShape::Cuboid { half_size } => random.within(1.0) * half_size,
        ColliderShape::Geometry(_) | ColliderShape::Deforming(_) => Vec3::ZERO,
        ColliderShape::HalfSpace => {
            let point = random.within(beyond);
            Vec3::new(point.x, -point.y.abs() * random.part(), point.z)
        }
    };
    // Within all of it by more than rounding: of lengths below 20 m, 20 × ε × 20 m.
    let pose = collider.pose_at(part);
    let point = pose * local;
    point - collider.shape.nearest(pose, point).normal * 5.0e-5
}

proptest! {
    #![proptest_config(cases(4_000))]

    /// All that is ever inside is found, wherever the collider is then.
    #[test]
    fn whatever_it_passes_is_met(seed in any::<u64>()) {
        let mut random = Random(seed);
        let shape = random.shape(2.0);
        let collider = random.moving(shape.clone(), 4.0, 6.0, 3.0);
        let cloth = BoundingSphere::new(random.within(4.0), random.between(0.5, 4.0));
        let probe = collider.probe(0.0, 0.0, &cloth);
        for time in 0..=32 {
            let part = time as f32 / 32.0;
            for _ in 0..4 {
                let point = inside(&mut random, &collider, part, collider.farthest_distance(&cloth));
                let is_cloth = point.distance(cloth.center.into()) <= cloth.radius();
                // Only a half-space is searched for no farther than the cloth.
                if is_cloth || shape != ColliderShape::HalfSpace {
                    prop_assert!(probe.meets(point), "{collider:?} {part} {point}");
                }
            }
        }
    }

    /// And all that comes inside after it has moved as far as the margin, out of the cloth's sphere, too.
    #[test]
    fn whatever_comes_into_its_way_is_met(seed in any::<u64>()) {
        let mut random = Random(seed);
        let shape = random.shape(2.0);
        let collider = random.moving(shape.clone(), 4.0, 6.0, 1.5);
        let cloth = BoundingSphere::new(random.within(4.0), random.between(0.5, 2.0));
        let margin = random.between(0.0, 3.0);
        let probe = collider.probe(margin, 0.0, &cloth);
        for time in 0..=32 {
            let part = time as f32 / 32.0;
            for _ in 0..8 {
                let point = inside(&mut random, &collider, part, collider.farthest_distance(&cloth) + margin);
                let before = point + random.direction() * margin * 0.999;
                if before.distance(cloth.center.into()) <= cloth.radius() {
                    prop_assert!(probe.meets(before), "{collider:?} {part} {point}");
                }
            }
        }
    }
}
