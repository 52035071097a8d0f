//! Where particles were, to see how far they have come since.

use bevy::math::Vec3;

use super::participant::Participant;
use crate::cloth::{DX, LANES, Lanes, Slot, X, Y, Z};

/// Where all particles of some cloths were, each in its own frame, block by block (m). What is no particle is nowhere (NaN).
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Origin {
    cloths: Vec<Vec<[Lanes; 3]>>,
}

impl Origin {
    /// Takes over where they are.
    pub fn set(&mut self, cloths: &[Participant]) {
        self.set_back(cloths, 0.0);
    }

    /// Takes over where they were as the sub-step began that they have just gone through.
    pub fn set_to_start(&mut self, cloths: &[Participant]) {
        self.set_back(cloths, 1.0);
    }

    /// Takes over another one.
    pub fn copy_from(&mut self, other: &Self) {
        self.cloths.clone_from(&other.cloths);
    }

    /// Takes over where they were this part of their last sub-step ago.
    fn set_back(&mut self, cloths: &[Participant], part: f32) {
        self.cloths.resize_with(cloths.len(), Vec::new);
        for (places, cloth) in self.cloths.iter_mut().zip(cloths) {
            let layout = cloth.particles.layout();
            let strip = layout.strip as usize;
            places.clear();
            places.extend(cloth.particles.blocks().iter().map(|block| {
                let view = block.view();
                [X, Y, Z].map(|axis| {
                    std::array::from_fn(|l| view[axis + l] - part * view[axis - X + DX + l])
                })
            }));
            for (block, lane) in (0..strip).flat_map(|block| (0..LANES).map(move |l| (block, l))) {
                if layout.column(block, lane).is_none() {
                    let row = places.iter_mut().skip(block).step_by(strip);
                    row.for_each(|place| place[0][lane] = f32::NAN);
                }
            }
        }
    }

    /// Where a particle of a cloth was, in that cloth's frame (m).
    pub fn place(&self, cloth: usize, slot: Slot) -> Vec3 {
        self.cloths[cloth][slot.block]
            .map(|axis| axis[slot.lane])
            .into()
    }

    /// Whether it is one of as many particles.
    pub fn is_of(&self, cloths: &[Participant]) -> bool {
        let sizes = |(places, cloth): (&Vec<_>, &Participant)| {
            places.len() == cloth.particles.blocks().len()
        };
        self.cloths.len() == cloths.len() && self.cloths.iter().zip(cloths).all(sizes)
    }

    /// Where all particles of a cloth were, block by block (m).
    pub fn places(&self, cloth: usize) -> &[[Lanes; 3]] {
        &self.cloths[cloth]
    }

    /// What one particle has come since, in the common frame (m): what all have in common does not bring them nearer to each other.
    pub fn drift(&self, cloths: &[Participant]) -> Vec3 {
        match (self.cloths.first(), cloths.first()) {
            (Some(places), Some(cloth)) => {
                let at = cloth.particles.layout().slot_of(cloth.particles.len() / 2);
                let place = places[at.block].map(|axis| axis[at.lane]);
                let moved =
                    cloth.particles.blocks()[at.block].position(at.lane) - Vec3::from(place);
                cloth.vector(moved)
            }
            _ => Vec3::ZERO,
        }
    }

    /// By how much any two of the particles can have come nearer to each other since, at most (m).
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
                    // What is nowhere is not farther.
                    farthest[l] = if square > farthest[l] {
                        square
                    } else {
                        farthest[l]
                    };
                }
            }
        }
        2.0 * farthest.into_iter().fold(0.0, f32::max).sqrt()
    }
}
