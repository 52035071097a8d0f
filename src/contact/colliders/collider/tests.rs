//! Scales and bad lengths.

use bevy::math::Quat;

use super::*;
use crate::cloth::ShapeError;

#[test]
fn shapes_are_scaled() {
    let scale = Vec3::new(1.0, -3.0, 2.0);
    let scaled = |collider: ClothCollider| collider.scaled(scale).expect("a valid collider");
    assert_eq!(
        scaled(ClothCollider::default()),
        ColliderShape::Ball { radius: 3.0 }
    );
    assert_eq!(
        scaled(ClothCollider::capsule(0.5, 2.0)),
        ColliderShape::Capsule {
            radius: 1.0,
            half_length: 3.0
        }
    );
    assert_eq!(
        scaled(ClothCollider::cuboid(2.0, 4.0, 6.0)),
        ColliderShape::Cuboid {
            half_size: Vec3::new(1.0, 6.0, 6.0)
        }
    );
    assert_eq!(scaled(ClothCollider::plane()), ColliderShape::HalfSpace);
}

#[test]
fn lengths_are_checked() {
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        for collider in [
            ClothCollider::ball(bad),
            ClothCollider::capsule(bad, 1.0),
            ClothCollider::cuboid(1.0, bad, 1.0),
        ] {
            assert!(collider.scaled(Vec3::ONE).is_err(), "{collider:?}");
        }
        let short = ClothCollider::capsule(1.0, bad).scaled(Vec3::ONE);
        assert_eq!(short.is_ok(), bad == 0.0, "{bad}");
    }
    for scale in [Vec3::ZERO, Vec3::INFINITY, Vec3::NAN] {
        for collider in [
            ClothCollider::ball(1.0),
            ClothCollider::capsule(1.0, 1.0),
            ClothCollider::cuboid(1.0, 1.0, 1.0),
        ] {
            assert!(collider.scaled(scale).is_err(), "{collider:?} {scale}");
        }
    }
}

/// A part has to be somewhere; a rotation that is longer than 1 is one.
#[test]
fn parts_of_a_compound_are_checked() {
    let ball = || ClothCollider::ball(0.1);
    let at = |place: Vec3, rotation: Quat| {
        let pose = Isometry3d {
            rotation,
            translation: place.into(),
        };
        ClothCollider::compound([(Isometry3d::IDENTITY, ball()), (pose, ball())]).scaled(Vec3::ONE)
    };
    for (place, rotation) in [
        (Vec3::new(0.0, f32::NAN, 0.0), Quat::IDENTITY),
        (Vec3::INFINITY, Quat::IDENTITY),
        (Vec3::X * 1.0e13, Quat::IDENTITY),
        (Vec3::X, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        (Vec3::X, Quat::NAN),
    ] {
        let outcome = at(place, rotation);
        assert!(
            matches!(
                outcome,
                Err(ClothError::Shape(ShapeError::PartPose { part: 1, .. }))
            ),
            "{place} {rotation}: {outcome:?}"
        );
    }
    let shape = at(Vec3::X, Quat::from_xyzw(0.0, 3.0, 0.0, 0.0)).expect("a valid compound");
    // Turned about y and as large as ever.
    assert!((shape.extent() - Vec3::new(1.1, 0.1, 0.1).length()).abs() < 1.0e-6);
}

/// An asset that is to be loaded is named as what can't be a part.
#[test]
fn a_mesh_asset_is_no_part() {
    let outcome =
        ClothCollider::compound([(Isometry3d::IDENTITY, ClothCollider::mesh())]).scaled(Vec3::ONE);
    assert!(
        matches!(&outcome, Err(ClothError::Shape(ShapeError::NoSuchShape { shape })) if shape.contains("Mesh3d")),
        "{outcome:?}"
    );
}
