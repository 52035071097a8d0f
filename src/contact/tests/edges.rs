//! That triangles are not pushed where no edge comes through them.

use bevy::math::{Isometry3d, Vec3};

use super::{all_of, build};
use crate::{
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::{ColliderShape, MovingCollider},
    },
    solver::SubStep,
};

/// Triangles that lie flat on a face, over its edges too, are not moved.
#[test]
fn what_lies_flat_is_left_alone() {
    let half_size = Vec3::new(0.3, 0.2, 0.3);
    let (surface, mut particles) = build(21, 21, 0.05);
    for index in 0..particles.len() {
        let place = particles.position(index).expect("it exists");
        let lying = Vec3::new(place.x - 0.5, 0.2101, place.y + 0.5);
        particles.set_position(index, lying).expect("it exists");
    }
    let before: Vec<Vec3> = particles.positions().collect();
    let shape = ColliderShape::Cuboid { half_size };
    let collider = MovingCollider::still(shape, Isometry3d::IDENTITY);
    let settings = ContactSettings {
        particle_radius: 0.01,
        narrow_phase: NarrowPhase::Triangles,
        ..ContactSettings::default()
    };
    let mut detection = all_of(
        std::slice::from_ref(&collider),
        &settings,
        &surface,
        &particles,
    );
    for index in 0..4 {
        let substep = SubStep {
            index,
            count: 4,
            farthest_move: 0.0,
        };
        assert!(!detection.respond(&mut particles, &settings, substep, |_| {}));
    }
    assert!(particles.positions().eq(before));
}
