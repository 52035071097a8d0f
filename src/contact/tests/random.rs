//! Random numbers, shapes and motions, the same each time.

use bevy::math::{Isometry3d, Quat, Vec3};
use proptest::prelude::ProptestConfig;

use crate::contact::colliders::{ClothCollider, ColliderShape, MovingCollider};

/// Whether tests are to run at their full length, which takes minutes: CI sets `BEVY_DRAPE_LONG`.
pub fn is_long() -> bool {
    std::env::var_os("BEVY_DRAPE_LONG").is_some()
}

/// A fifth of this many cases, that are the same each time, and all of them where tests run at their full length.
pub fn many_cases(at_length: u32) -> ProptestConfig {
    cases(if is_long() { at_length } else { at_length / 5 })
}

/// This many cases, that are the same each time.
pub fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(42),
        ..ProptestConfig::default()
    }
}

/// By `SplitMix64`.
#[derive(Clone)]
pub struct Random(pub u64);

impl Random {
    /// From 0 to 1.
    pub fn part(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.part()
    }

    /// Less than `count`.
    pub fn below(&mut self, count: u32) -> u32 {
        ((self.part() * count as f32) as u32).min(count - 1)
    }

    /// In a cube that reaches so far from the origin.
    pub fn within(&mut self, limit: f32) -> Vec3 {
        Vec3::new(
            self.between(-limit, limit),
            self.between(-limit, limit),
            self.between(-limit, limit),
        )
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let direction = self.within(1.0);
            if (0.01..1.0).contains(&direction.length()) {
                return direction.normalize();
            }
        }
    }

    pub fn rotation(&mut self) -> Quat {
        let angle = self.between(0.0, std::f32::consts::PI);
        Quat::from_axis_angle(self.direction(), angle)
    }

    pub fn pose(&mut self, limit: f32) -> Isometry3d {
        Isometry3d::new(self.within(limit), self.rotation())
    }

    /// A ball, capsule, box or half-space, up to about `size` (m).
    pub fn shape(&mut self, size: f32) -> ColliderShape {
        let kind = self.below(4);
        self.shape_of(kind, size)
    }

    pub fn shape_of(&mut self, kind: u32, size: f32) -> ColliderShape {
        let mut length = || self.between(0.1, 1.0) * size;
        match kind {
            0 => ColliderShape::Ball { radius: length() },
            1 => ColliderShape::Capsule {
                radius: length(),
                half_length: length(),
            },
            2 => ColliderShape::Cuboid {
                half_size: Vec3::new(length(), length(), length()),
            },
            _ => ColliderShape::HalfSpace,
        }
    }

    /// A cylinder, a cone, a hull, or several, up to about 1 m.
    pub fn geometry(&mut self) -> ClothCollider {
        match self.below(5) {
            0 => ClothCollider::cylinder(self.between(0.1, 0.8), self.between(0.1, 1.5)),
            1 => ClothCollider::cone(self.between(0.1, 0.8), self.between(0.2, 1.5)),
            2 => {
                let points: Vec<Vec3> = (0..9).map(|_| self.within(0.8)).collect();
                ClothCollider::convex_hull(points)
            }
            3 => {
                // A mesh, and a part that is none.
                let points: Vec<Vec3> = (0..9).map(|_| self.within(0.8)).collect();
                let apart = Isometry3d::from_xyz(0.0, 2.0, 0.0);
                let ball = (apart, ClothCollider::ball(self.between(0.1, 0.8)));
                ClothCollider::compound([
                    ball,
                    (Isometry3d::IDENTITY, ClothCollider::convex_hull(points)),
                ])
            }
            _ => {
                let apart = Isometry3d::from_xyz(0.0, 2.0, 0.0);
                let cone = ClothCollider::cone(self.between(0.1, 0.8), 1.0);
                let part = (
                    self.pose(0.2),
                    ClothCollider::cuboid(0.5, self.between(0.2, 1.0), 0.7),
                );
                ClothCollider::compound([part, (apart, cone)])
            }
        }
    }

    /// Somewhere within `place` (m), moving so far and turning so much at most (m, rad).
    pub fn moving(
        &mut self,
        shape: ColliderShape,
        place: f32,
        travel: f32,
        turn: f32,
    ) -> MovingCollider {
        let from = self.pose(place);
        MovingCollider {
            shape,
            from,
            to: Vec3::from(from.translation) + self.direction() * travel * self.part(),
            turn: self.direction() * turn * self.part(),
            body: None,
        }
    }
}
