//! How far particles reach, and how far they have moved.

use bevy::math::{Vec3, bounding::BoundingSphere};

use super::ClothParticles;
use crate::cloth::{
    lanes::{DX, LANES, X, Y, Z, larger},
    surface::Surface,
};

/// Number of blocks compared at a time.
const BLOCKS: usize = 64;

impl ClothParticles {
    /// The largest distance of a particle from its position in `other`, now or before its last displacement (m). NaN if
    /// any position is NaN.
    pub(crate) fn farthest_from(&self, other: &Self) -> f32 {
        let (mut largest, mut is_nan) = ([0.0_f32; LANES], [false; LANES]);
        for (block, was) in self.blocks.iter().zip(&other.blocks) {
            let (view, was) = (block.view(), was.view());
            for lane in 0..LANES {
                let (mut now, mut before) = (0.0, 0.0);
                for axis in [X, X + LANES, X + 2 * LANES] {
                    let moved = view[axis + lane] - was[axis + lane];
                    let came = moved - view[DX + axis + lane];
                    now += moved * moved;
                    before += came * came;
                }
                is_nan[lane] |= (now + before).is_nan();
                largest[lane] = larger(larger(now, before), largest[lane]);
            }
        }
        if is_nan.contains(&true) {
            return f32::NAN;
        }
        largest.into_iter().fold(0.0, f32::max).sqrt() * (1.0 + 1.0e-6)
    }

    /// Whether every particle is within `reach` (m) of its position in `other`. False for different particles, or if a
    /// position is NaN.
    pub(crate) fn stays_within(&self, reach: f32, other: &Self) -> bool {
        if self.layout != other.layout {
            return false;
        }
        let blocks = self.blocks.chunks(BLOCKS).zip(other.blocks.chunks(BLOCKS));
        // The first few blocks usually show a motion.
        blocks.into_iter().all(|(now, before)| {
            // NaN survives a sum, and the square of infinity is infinite.
            let (mut largest, mut sum) = ([0.0_f32; LANES], [0.0_f32; LANES]);
            for (block, was) in now.iter().zip(before) {
                let (view, was) = (block.view(), was.view());
                for lane in 0..LANES {
                    let x = view[X + lane] - was[X + lane];
                    let y = view[Y + lane] - was[Y + lane];
                    let z = view[Z + lane] - was[Z + lane];
                    let square = x * x + y * y + z * z;
                    sum[lane] += square;
                    largest[lane] = larger(square, largest[lane]);
                }
            }
            let farthest = largest.into_iter().fold(0.0, f32::max);
            farthest <= reach * reach && sum.iter().all(|sum| !sum.is_nan())
        })
    }

    /// A bounding sphere of all particles (m).
    pub(crate) fn bounding_sphere(&self) -> BoundingSphere {
        let low = self.positions().fold(Vec3::MAX, Vec3::min);
        let high = self.positions().fold(Vec3::MIN, Vec3::max);
        let radius = low.distance(high) / 2.0 * (1.0 + 1.0e-5);
        BoundingSphere::new(low.midpoint(high), radius.max(0.0))
    }

    /// The largest distance from a particle to a corner of its faces (m).
    pub(crate) fn longest_face_reach(&self, surface: &Surface) -> f32 {
        let mut longest = 0.0_f32;
        for particle in 0..self.len() as u32 {
            let from = self.position_at(particle as usize);
            for corner in surface.faces().of(particle).iter().flatten() {
                longest = longest.max(from.distance_squared(self.position_at(*corner as usize)));
            }
        }
        longest.sqrt()
    }
}
