//! Holds resting layers between the sub-steps in which their pairs are tested.
//!
//! A resting layer gets the same push in every sub-step: the one that carries its weight. So each particle is held by
//! the mean of its last pushes, as far as that stops it: the part of its motion against them is removed.
//!
//! ```text
//!   d: mean change of the displacement m by the last pushes
//!   m ← m + s d      s = −m·d / d², no less than 0 and no more than MOST
//!   |m + s d|² = m² − s d² (2 (−m·d / d²) − s) ≤ m²
//! ```
//!
//! So this never adds energy to a particle, even if the contact has ended since. It does not conserve momentum, and is
//! therefore used only for particles that rest on something.

use bevy::math::Vec3;
use multiversion::multiversion;

use super::{origin::Origin, participant::Participant};
use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, Slot, X, larger, smaller};

/// The mean of the last pushes of each particle of some cloths, each in its own frame, block by block (m per sub-step).
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct MeanPushes {
    cloths: Vec<Vec<[Lanes; 3]>>,
}

/// Weight of the latest push in the mean. The particles that carry a layer's weight vary from one sub-step to the next.
pub(super) const LATEST: f32 = 0.3;

/// Largest hold of a particle, in means of its last pushes.
const MOST: f32 = 4.0;

/// Largest displacement squared, lane by lane (m²).
#[derive(Debug, Default, Clone, Copy)]
struct Farthest {
    push: Lanes,
    travel: Lanes,
}

impl MeanPushes {
    /// Clears the holds of these cloths.
    pub fn clear(&mut self, cloths: &[Participant]) {
        self.cloths.resize_with(cloths.len(), Vec::new);
        for (pushes, cloth) in self.cloths.iter_mut().zip(cloths) {
            pushes.clear();
            pushes.resize(cloth.particles.blocks().len(), [[0.0; LANES]; 3]);
        }
    }

    /// Begins a sub-step in which pairs are tested: a particle that is not pushed counts, too.
    pub fn pass(&mut self) {
        for numbers in self.cloths.iter_mut().flatten() {
            for number in numbers.as_flattened_mut() {
                // Subnormals would be slow.
                let is_left = number.abs() > f32::MIN_POSITIVE;
                *number *= if is_left { 1.0 - LATEST } else { 0.0 };
            }
        }
    }

    /// Adds a push to the mean of a particle's last ones, in its cloth's frame (m per sub-step).
    pub fn add(&mut self, cloth: usize, Slot { block, lane }: Slot, push: Vec3) {
        for (axis, push) in self.cloths[cloth][block].iter_mut().zip(push.to_array()) {
            axis[lane] += LATEST * push;
        }
    }

    /// Holds everything that was pushed, and marks the affected cloths. Returns the largest push, and the largest
    /// approach of any two particles since `passed` (m).
    pub fn apply(
        &self,
        cloths: &mut [Participant],
        passed: &Origin,
        is_pushed: &mut [bool],
    ) -> (f32, f32) {
        let drift = passed.drift(cloths);
        let longest = |squares: Lanes| squares.into_iter().fold(0.0, f32::max).sqrt();
        let (mut pushed, mut travel) = (0.0_f32, 0.0_f32);
        for (index, cloth) in cloths.iter_mut().enumerate() {
            let mut farthest = Farthest::default();
            let drift = cloth.own_vector(drift).to_array();
            let places = passed.places(index);
            let blocks = cloth.particles.blocks_mut();
            hold(blocks, &self.cloths[index], places, drift, &mut farthest);
            is_pushed[index] |= farthest.push != [0.0; LANES];
            pushed = pushed.max(longest(farthest.push));
            travel = travel.max(longest(farthest.travel));
        }
        (pushed, 2.0 * travel)
    }
}

#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
fn hold(
    blocks: &mut [Block],
    pushes: &[[Lanes; 3]],
    places: &[[Lanes; 3]],
    drift: [f32; 3],
    farthest: &mut Farthest,
) {
    for ((block, push), place) in blocks.iter_mut().zip(pushes).zip(places) {
        let view = block.view_mut();
        let (mut part, mut squares) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            let [x, y, z] = [push[0][l], push[1][l], push[2][l]];
            let against = -(view[DX + l] * x + view[DY + l] * y + view[DZ + l] * z);
            let square = x * x + y * y + z * z;
            // 0 for particles that were not pushed.
            let s = against / square.max(f32::MIN_POSITIVE);
            part[l] = smaller(larger(s, 0.0), MOST);
            squares[l] = part[l] * part[l] * square;
        }
        let mut travel = [0.0; LANES];
        for axis in 0..3 {
            for l in 0..LANES {
                let by = part[l] * push[axis][l];
                view[X + axis * LANES + l] += by;
                view[DX + axis * LANES + l] += by;
                let came = view[X + axis * LANES + l] - place[axis][l] - drift[axis];
                travel[l] += came * came;
            }
        }
        for l in 0..LANES {
            // NaN is never the farthest.
            farthest.push[l] = larger(squares[l], farthest.push[l]);
            farthest.travel[l] = larger(travel[l], farthest.travel[l]);
        }
    }
}
