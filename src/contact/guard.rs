//! How far particles have moved since the candidates were searched for, so that what cannot touch yet is not tested.

use multiversion::multiversion;

use super::candidates::ContactBlock;
use crate::cloth::{Block, ClothParticles, LANES, Slot, X};

/// Displacements since the search: of the particles, block by block, and of a shape's surface.
///
/// A test of positions that finds nothing within a room r (m) holds until the particles and the surface have moved by r
/// since. With u the displacement from the search, that is so while u(now) ≤ r − u(then): the triangle inequality. So a
/// fast corner of the cloth costs tests around it, and nowhere else.
#[derive(Debug, Default, Clone)]
pub(super) struct Guard {
    /// For each of the cloth's blocks, the largest displacement of its particles (m); only those of the shape's
    /// candidates are up to date.
    moved: Vec<f32>,
    /// The largest of these (m).
    most: f32,
    /// Length of the path of the shape's surface (m).
    carried: f32,
}

impl Guard {
    /// Measures the particles of a shape's `contacts` against their places at the search, `origin`. The surface has been
    /// `carried` this far (m).
    pub fn measure(
        &mut self,
        particles: &ClothParticles,
        origin: &ClothParticles,
        contacts: &[ContactBlock],
        carried: f32,
    ) {
        let blocks = particles.blocks();
        self.moved.resize(blocks.len(), 0.0);
        self.carried = carried;
        self.most = measure(blocks, origin.blocks(), contacts, &mut self.moved);
    }

    /// A particle was pushed, by at most this much (m).
    pub fn note(&mut self, slot: Slot, push: f32) {
        let moved = &mut self.moved[slot.block];
        *moved += push;
        self.most = larger(self.most, *moved);
    }

    /// Until when a room (m) lasts that was found around particles: for [`is_clear`](Self::is_clear).
    pub fn until(&self, room: f32, around: &[Slot]) -> f32 {
        room - self.moved(around) + self.carried
    }

    /// Whether none of the particles have moved as far as `until`, nor the surface. False for NaN.
    #[inline]
    pub fn is_clear(&self, until: f32, around: &[Slot]) -> bool {
        let left = until - self.carried;
        left > self.most || left > self.moved(around)
    }

    #[inline]
    fn moved(&self, around: &[Slot]) -> f32 {
        let of = around.iter().map(|slot| self.moved[slot.block]);
        of.fold(0.0, larger)
    }
}

/// The larger of two; NaN is the largest.
#[inline]
fn larger(a: f32, b: f32) -> f32 {
    if b <= a || a.is_nan() { a } else { b }
}

/// Returns the largest displacement (m); NaN if a position is.
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
fn measure(
    blocks: &[Block],
    origin: &[Block],
    contacts: &[ContactBlock],
    moved: &mut [f32],
) -> f32 {
    let mut most = 0.0_f32;
    for contact in contacts {
        let block = contact.block as usize;
        let (now, then) = (blocks[block].view(), origin[block].view());
        let mut squares = [0.0_f32; LANES];
        for axis in [X, X + LANES, X + 2 * LANES] {
            for lane in 0..LANES {
                let apart = now[axis + lane] - then[axis + lane];
                squares[lane] += apart * apart;
            }
        }
        let square = squares.into_iter().fold(0.0, larger);
        moved[block] = square.sqrt() * (1.0 + 1.0e-6);
        most = larger(most, moved[block]);
    }
    most
}
