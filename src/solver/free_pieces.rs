//! Pieces of a cloth without pins, which fall freely: damping acts relative to the centre of mass of each.

use bevy::math::{DVec3, Vec3};

use crate::cloth::{Block, ClothParticles, Slot, Surface};

/// The pieces of a cloth in several pieces that no pin holds. None of a cloth of one piece.
#[derive(Debug, Default, Clone)]
pub(crate) struct FreePieces {
    all: Vec<FreePiece>,
    /// The lanes of each block that are theirs, as bits; none if there are no such pieces.
    lanes: Vec<u8>,
}

#[derive(Debug, Default, Clone)]
struct FreePiece {
    slots: Vec<Slot>,
    /// Displacement of its centre of mass in the sub-step before (m); `None` if all of it is held, or nothing is damped.
    displacement: Option<Vec3>,
}

impl FreePieces {
    /// Those of a surface with these particles.
    pub fn new(surface: &Surface, particles: &ClothParticles) -> Self {
        if surface.pieces() < 2 {
            return Self::default();
        }
        let of_particle = surface.pieces_of();
        let count = of_particle
            .iter()
            .max()
            .map_or(0, |last| *last as usize + 1);
        let mut is_held = vec![false; count];
        for (piece, inverse_mass) in of_particle.iter().zip(particles.inverse_masses()) {
            is_held[*piece as usize] |= inverse_mass == 0.0;
        }
        let layout = surface.layout();
        let blocks = match is_held.contains(&false) {
            true => layout.blocks(),
            false => 0,
        };
        let mut lanes = vec![0; blocks];
        let mut pieces = vec![FreePiece::default(); count];
        for (piece, slot) in of_particle.iter().zip(layout.slots()) {
            if !is_held[*piece as usize] {
                pieces[*piece as usize].slots.push(slot);
                lanes[slot.block] |= 1 << slot.lane;
            }
        }
        pieces.retain(|piece| !piece.slots.is_empty());
        Self { all: pieces, lanes }
    }

    /// Whether a particle is part of one.
    #[inline]
    pub fn hold(&self, block: usize, lane: usize) -> bool {
        self.lanes
            .get(block)
            .is_some_and(|lanes| lanes & (1 << lane) != 0)
    }

    /// Measures how the centres of mass have moved in the last sub-step, if there is any damping.
    pub fn measure(&mut self, blocks: &[Block], damping: f32) {
        for piece in &mut self.all {
            piece.displacement = None;
            let is_held = |slot: &Slot| blocks[slot.block].inverse_mass(slot.lane) == 0.0;
            // One that sleeps is held as a whole.
            if damping == 0.0 || piece.slots.first().is_none_or(is_held) {
                continue;
            }
            let (mut mass, mut moment) = (0.0, DVec3::ZERO);
            for slot in &piece.slots {
                let block = &blocks[slot.block];
                let inverse_mass = f64::from(block.inverse_mass(slot.lane));
                if inverse_mass > 0.0 {
                    mass += 1.0 / inverse_mass;
                    moment += block.displacement(slot.lane).as_dvec3() / inverse_mass;
                }
            }
            piece.displacement = (mass > 0.0).then(|| (moment / mass).as_vec3());
        }
    }

    /// Moves the free particles of each piece on by what `more` makes of the displacement of its centre of mass (m).
    pub fn shift(&self, blocks: &mut [Block], more: impl Fn(Vec3) -> Vec3) {
        for FreePiece {
            slots,
            displacement,
        } in &self.all
        {
            let Some(more) = displacement.map(&more) else {
                continue;
            };
            for slot in slots {
                let block = &mut blocks[slot.block];
                if block.inverse_mass(slot.lane) > 0.0 {
                    block.set_displacement(slot.lane, block.displacement(slot.lane) + more);
                }
            }
        }
    }
}
