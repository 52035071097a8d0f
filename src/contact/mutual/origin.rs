//! Where particles were, to see how far they have come since.

use bevy::math::Vec3;

use super::participant::Participant;
use crate::cloth::{DX, LANES, Lanes, Slot, X, Y, Z};

/// Where all particles of some cloths were, each in its own frame, block by block (m). What is no particle is nowhere (NaN).
#[derive(Debug, Default, Clone)]
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
            places.clear();
            let blocks = cloth.particles.blocks().iter().enumerate();
            places.extend(blocks.map(|(index, block)| {
                let view = block.view();
                let mut place = [X, Y, Z].map(|axis| {
                    std::array::from_fn(|l| view[axis + l] - part * view[axis - X + DX + l])
                });
                for (lane, x) in place[0].iter_mut().enumerate() {
                    if layout.column(index % layout.strip as usize, lane).is_none() {
                        *x = f32::NAN;
                    }
                }
                place
            }));
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

    /// By how much any two of the particles can have come nearer to each other since, at most (m).
    pub fn approach(&self, cloths: &[Participant]) -> f32 {
        // Whatever all have in common does not count: here what one particle has come.
        let drift = match (self.cloths.first(), cloths.first()) {
            (Some(places), Some(cloth)) => {
                let at = cloth.particles.layout().slot_of(cloth.particles.len() / 2);
                let place = places[at.block].map(|axis| axis[at.lane]);
                let moved =
                    cloth.particles.blocks()[at.block].position(at.lane) - Vec3::from(place);
                cloth.vector(moved)
            }
            _ => return 0.0,
        };
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
