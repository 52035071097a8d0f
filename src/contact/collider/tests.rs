//! Scales and bad lengths.

use super::*;

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
