//! Earlier positions of particles, to measure their approach since.

use bevy::math::Vec3;

use super::participant::Participant;
use crate::cloth::{LANES, Lanes, MapInline, Slot, X, Y, Z, larger};

/// Earlier positions of all particles of some cloths, each in its own frame, block by block (m). Empty lanes are NaN.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Origin {
    cloths: Vec<Vec<[Lanes; 3]>>,
}

impl Origin {
    /// Stores the current positions.
    pub fn set(&mut self, cloths: &[Participant]) {
        self.cloths.resize_with(cloths.len(), Vec::new);
        for (places, cloth) in self.cloths.iter_mut().zip(cloths) {
            let layout = cloth.particles.layout();
            places.clear();
            places.extend(cloth.particles.blocks().iter().map(|block| {
                let view = block.view();
                [X, Y, Z].map_inline(|axis| std::array::from_fn(|l| view[axis + l]))
            }));
            for (block, place) in places.iter_mut().enumerate() {
                for (lane, x) in place[0].iter_mut().enumerate() {
                    if layout.index_at(block, lane).is_none() {
                        *x = f32::NAN;
                    }
                }
            }
        }
    }

    pub fn clear(&mut self) {
        self.cloths.iter_mut().for_each(Vec::clear);
    }

    /// Whether no pinned particle has moved since.
    pub fn are_pins_still(&self, cloths: &[Participant]) -> bool {
        self.cloths.iter().zip(cloths).all(|(places, cloth)| {
            let mut each = places.iter().zip(cloth.particles.blocks());
            each.all(|(before, block)| {
                (0..LANES).all(|lane| {
                    let before = Vec3::from(before.map_inline(|axis| axis[lane]));
                    // Empty lanes are NaN.
                    block.inverse_mass(lane) > 0.0
                        || before.is_nan()
                        || before == block.position(lane)
                })
            })
        })
    }

    /// Puts all particles that may move back where they were, at rest, and marks their cloths. Returns how far, at most (m).
    pub fn put_back(&self, cloths: &mut [Participant], is_pushed: &mut [bool]) -> f32 {
        let mut farthest = 0.0_f32;
        let each = self.cloths.iter().zip(cloths).zip(is_pushed);
        let is_stored = |places: &[_], cloth: &Participant| !places.is_empty() && !cloth.is_fixed;
        for ((places, cloth), is_pushed) in each.filter(|((a, b), _)| is_stored(a, b)) {
            *is_pushed = true;
            for (before, block) in places.iter().zip(cloth.particles.blocks_mut()) {
                for lane in 0..LANES {
                    let before = Vec3::from(before.map_inline(|axis| axis[lane]));
                    if block.inverse_mass(lane) > 0.0 && !before.is_nan() {
                        farthest = farthest.max(before.distance(block.position(lane)));
                        block.set_position(lane, before);
                        block.set_displacement(lane, Vec3::ZERO);
                    }
                }
            }
        }
        farthest
    }

    /// Displacement of a particle since, in its cloth's frame (m); `None` if nothing is stored.
    #[inline]
    pub fn moved(&self, cloth: usize, slot: Slot, place: Vec3) -> Option<Vec3> {
        let places = self.cloths.get(cloth)?;
        let before = places.get(slot.block)?.map_inline(|axis| axis[slot.lane]);
        Some(place - Vec3::from(before))
    }

    /// Positions of all particles of a cloth, block by block (m).
    pub fn places(&self, cloth: usize) -> &[[Lanes; 3]] {
        &self.cloths[cloth]
    }

    /// Displacement of one particle since, in the common frame (m): common motion does not change distances.
    pub fn drift(&self, cloths: &[Participant]) -> Vec3 {
        match (self.cloths.first(), cloths.first()) {
            (Some(places), Some(cloth)) if !places.is_empty() => {
                let at = cloth.particles.layout().slot_of(cloth.particles.len() / 2);
                let place = places[at.block].map_inline(|axis| axis[at.lane]);
                let moved =
                    cloth.particles.blocks()[at.block].position(at.lane) - Vec3::from(place);
                cloth.vector(moved)
            }
            _ => Vec3::ZERO,
        }
    }

    /// Largest approach of any two particles since (m).
    pub fn approach(&self, cloths: &[Participant]) -> f32 {
        let drift = self.drift(cloths);
        let mut farthest = [0.0_f32; LANES];
        for (places, cloth) in self.cloths.iter().zip(cloths) {
            let drift = cloth.own_vector(drift);
            for (place, block) in places.iter().zip(cloth.particles.blocks()) {
                let view = block.view();
                for l in 0..LANES {
                    let x = view[X + l] - place[0][l] - drift.x;
                    let y = view[Y + l] - place[1][l] - drift.y;
                    let z = view[Z + l] - place[2][l] - drift.z;
                    let square = x * x + y * y + z * z;
                    // NaN is never the farthest.
                    farthest[l] = larger(square, farthest[l]);
                }
            }
        }
        2.0 * farthest.into_iter().fold(0.0, f32::max).sqrt()
    }
}
