//! How far particles have moved since the candidates were searched for, so that what cannot touch yet is not tested.

use multiversion::multiversion;

use super::blocks::ContactBlock;
use crate::cloth::{Block, ClothParticles, DX, LANES, Lanes, Slot, X, larger_or_nan};

/// Displacements since the search: of each particle, and of a shape's surface.
///
/// A test of positions that finds nothing within a clearance r (m) holds until the particles and the surface have moved by r
/// since. With u the displacement from the search, that is so while u(now) ≤ r − u(then): the triangle inequality. So a
/// fast corner of the cloth costs tests around it, and nowhere else.
#[derive(Debug, Default, Clone)]
pub(crate) struct Guard {
    /// Displacement of each particle (m), by the cloth's blocks; only those of the shape's blocks are up to date.
    moved: Vec<Lanes>,
    /// The largest of these (m).
    most: f32,
    /// Length of the path of the shape's surface (m).
    carried: f32,
    /// The largest sum of both before the next search (m).
    limit: f32,
}

impl Guard {
    /// Measures the particles of a shape's `contacts` against their places at the search, `origin`. The surface has been
    /// `carried` this far (m). All are searched for again before both have moved by `limit` (m).
    pub fn measure(
        &mut self,
        particles: &ClothParticles,
        origin: &ClothParticles,
        contacts: &[ContactBlock],
        [carried, limit]: [f32; 2],
    ) {
        let blocks = particles.blocks();
        self.moved.resize(blocks.len(), [0.0; LANES]);
        (self.carried, self.limit) = (carried, limit);
        self.most = measure(blocks, origin.blocks(), contacts, &mut self.moved);
    }

    /// Tells blocks how far their particles have moved.
    pub fn tell(&self, contacts: &mut [ContactBlock]) {
        for contact in contacts {
            let moved = &self.moved[contact.block as usize];
            contact.moved = moved.iter().copied().fold(0.0, larger_or_nan);
        }
    }

    /// A particle was pushed, by at most this much (m).
    pub fn note(&mut self, slot: Slot, push: f32) {
        let moved = &mut self.moved[slot.block][slot.lane];
        *moved += push;
        self.most = larger_or_nan(self.most, *moved);
    }

    /// Until when a clearance (m) lasts that was found around particles: for [`is_clear`](Self::is_clear).
    pub fn until(&self, clearance: f32, around: &[Slot]) -> f32 {
        clearance - self.moved(around) + self.carried
    }

    /// Whether nothing moves as far as `until` before the next search, unless it is outrun.
    pub fn is_clear_for_good(&self, until: f32) -> bool {
        until > self.limit
    }

    /// Whether a push has moved a particle farther than was expected before the next search.
    pub fn is_outrun(&self) -> bool {
        self.most + self.carried > self.limit
    }

    /// Whether none of the particles have moved as far as `until`, nor the surface. False for NaN.
    #[inline]
    pub fn is_clear(&self, until: f32, around: &[Slot]) -> bool {
        let left = until - self.carried;
        left > self.most || left > self.moved(around)
    }

    #[inline]
    fn moved(&self, around: &[Slot]) -> f32 {
        let each = around.iter().map(|slot| self.moved[slot.block][slot.lane]);
        each.fold(0.0, larger_or_nan)
    }
}

/// Returns the largest displacement (m); NaN if a position is.
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
fn measure(
    blocks: &[Block],
    origin: &[Block],
    contacts: &[ContactBlock],
    moved: &mut [Lanes],
) -> f32 {
    let mut most = [0.0_f32; LANES];
    for contact in contacts {
        let block = contact.block as usize;
        let (now, then) = (blocks[block].view(), origin[block].view());
        // Swept tests begin where a particle's displacement does, even if pushes moved it on without one.
        let (mut ends, mut starts) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for axis in 0..3 {
            let (at, displacement) = (X + axis * LANES, DX + axis * LANES);
            for lane in 0..LANES {
                let apart = now[at + lane] - then[at + lane];
                let before = apart - now[displacement + lane];
                ends[lane] += apart * apart;
                starts[lane] += before * before;
            }
        }
        for lane in 0..LANES {
            let far = larger_or_nan(ends[lane], starts[lane]).sqrt() * (1.0 + 1.0e-6);
            moved[block][lane] = far;
            most[lane] = larger_or_nan(most[lane], far);
        }
    }
    most.into_iter().fold(0.0, larger_or_nan)
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;

    use super::*;
    use crate::{
        cloth::{Cloth, ClothMaterial},
        contact::tests::Random,
    };

    fn at(particles: &ClothParticles, slot: Slot) -> Vec3 {
        particles.blocks()[slot.block].position(slot.lane)
    }

    /// Until when it is clear, its clearance (m), around whom, where they were, and how far the surface had been carried (m).
    type Tested = (f32, f32, [Slot; 3], [Vec3; 3], f32);

    /// Particles that walk at random, one of them far: what is said to be clear has not moved by its clearance since, from any
    /// test to any later one, and most of what is far from the fast one is clear.
    #[test]
    fn what_is_clear_has_not_used_its_clearance() {
        let surface = Cloth::new(20, 20, 0.1).surface(Vec3::ONE).expect("a grid");
        let mut particles =
            ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("particles");
        let origin = particles.clone();
        let layout = particles.layout();
        let contacts: Vec<ContactBlock> = (0..particles.blocks().len() as u32)
            .map(ContactBlock::new)
            .collect();
        let mut random = Random(5);
        let mut guard = Guard::default();
        let mut tested: Vec<Tested> = Vec::new();
        let (mut clear, mut carried) = (0, 0.0);
        for step in 0..40 {
            for index in 0..particles.len() {
                let displacement = random.within(if index == 77 { 0.1 } else { 0.002 });
                particles.put(index, particles.position_at(index) + displacement);
            }
            carried += random.between(0.0, 0.001);
            guard.measure(&particles, &origin, &contacts, [carried, 1.0]);
            // One is pushed after the measurement.
            let (slot, push) = (layout.slot_of(33), random.within(0.01));
            particles.put(33, particles.position_at(33) + push);
            guard.note(slot, push.length() * (1.0 + 1.0e-5));
            for (until, clearance, around, places, then) in &tested {
                if !guard.is_clear(*until, around) {
                    continue;
                }
                clear += 1;
                for (slot, place) in around.iter().zip(places) {
                    let moved = at(&particles, *slot).distance(*place) + carried - then;
                    assert!(
                        moved < *clearance,
                        "{moved} m of {clearance} m in step {step}"
                    );
                }
            }
            for _ in 0..20 {
                let first = random.below(380) as usize;
                let around =
                    [first, first + 1, first + 20].map(|index| layout.slot_of(index.min(399)));
                let clearance = random.between(0.0, 0.06);
                let places = around.map(|slot| at(&particles, slot));
                let until = guard.until(clearance, &around);
                tested.push((until, clearance, around, places, carried));
            }
        }
        assert!(clear > 1000, "{clear} tests were spared");
    }

    /// A position that is no number makes nothing clear.
    #[test]
    fn no_number_is_never_clear() {
        let surface = Cloth::new(3, 3, 0.1).surface(Vec3::ONE).expect("a grid");
        let mut particles =
            ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("particles");
        let origin = particles.clone();
        let slot = particles.layout().slot_of(4);
        particles.put(4, Vec3::NAN);
        let contacts: Vec<ContactBlock> = (0..particles.blocks().len() as u32)
            .map(ContactBlock::new)
            .collect();
        let mut guard = Guard::default();
        guard.measure(&particles, &origin, &contacts, [0.0, 1.0]);
        assert!(!guard.is_clear(1.0, &[slot]));
        assert!(!guard.is_clear(guard.until(1.0, &[slot]), &[slot]));
    }
}
