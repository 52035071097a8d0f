//! Numbers from a seed, of which some are bad.

use bevy::prelude::*;

/// `SplitMix64` (Steele, Lea, Flood 2014).
#[derive(Resource, Clone)]
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }

    pub fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    pub fn pick<'a, T>(&mut self, all: &'a [T]) -> Option<&'a T> {
        let index = self.below(all.len());
        all.get(index)
    }

    /// From 0 to 1.
    pub fn part(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// A number that a game might write, or one that nobody means.
    pub fn number(&mut self) -> f32 {
        if self.below(3) > 0 {
            return match self.below(3) {
                0 => self.part(),
                1 => self.part() * 4.0 - 2.0,
                _ => self.part() * self.part() * 40.0,
            };
        }
        let bad = [
            0.0,
            -0.0,
            -1.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN_POSITIVE,
            1.0e-30,
            1.0e-6,
            1.0e4,
            1.0e9,
            1.0e12,
            1.0e19,
            -1.0e30,
        ];
        bad[self.below(bad.len())]
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    /// About where the others are.
    pub fn place(&mut self) -> Vec3 {
        if self.one_in(12) {
            return self.vector();
        }
        Vec3::new(self.part(), self.part(), self.part()) * 2.0 - 1.0
    }
}
