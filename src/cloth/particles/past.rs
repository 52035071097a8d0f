//! What particles remember of their motion, for a method of second order.

use bevy::math::Vec3;

use crate::cloth::{Block, LANES, Lanes, Slot};

/// The displacements of eight particles in the two sub-steps before the last (m): x, y and z of the one before, then of the one
/// before that.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Earlier(pub [Lanes; 6]);

impl Earlier {
    const NONE: Self = Self([[0.0; LANES]; 6]);
}

/// Displacements in earlier sub-steps.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Past {
    /// Block by block; none where all is of first order.
    pub blocks: Vec<Earlier>,
    /// Whether they are known.
    is_known: bool,
    /// For how many sub-steps to come the past says nothing of the future.
    wait: u32,
}

/// Of which order a sub-step is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StepKind {
    /// Implicit Euler.
    First,
    /// The first of second order, from position and velocity alone.
    Start,
    /// BDF2.
    Second,
}

impl Past {
    /// Forgets all but the velocity, and waits for nothing.
    pub fn end(&mut self, now: &mut [Block]) {
        self.restart(now, 1.0);
        self.wait = 0;
    }

    /// Forgets all, and lets this many sub-steps of first order pass first.
    pub fn forget(&mut self, wait: u32) {
        self.is_known = false;
        self.wait = self.wait.max(wait);
    }

    /// Of which order the coming sub-step is, if the second is wanted.
    pub fn next(&mut self, blocks: usize) -> StepKind {
        if self.blocks.len() != blocks {
            self.blocks.clear();
            self.blocks.resize(blocks, Earlier::NONE);
            self.is_known = false;
        }
        if self.wait > 0 {
            self.wait -= 1;
            return StepKind::First;
        }
        if self.is_known {
            return StepKind::Second;
        }
        self.is_known = true;
        StepKind::Start
    }

    /// Forgets all but the velocity: displacements become what it makes of a sub-step `ratio` times as long, to second order
    /// where the past is known.
    pub fn restart(&mut self, now: &mut [Block], ratio: f32) {
        if !self.is_known || self.blocks.len() != now.len() {
            for moved in now.iter_mut().flat_map(Block::displacements_mut) {
                *moved *= ratio;
            }
            return;
        }
        self.is_known = false;
        for (block, Earlier(earlier)) in now.iter_mut().zip(&self.blocks) {
            let moved = block.displacements_mut();
            for axis in 0..3 {
                for lane in 0..LANES {
                    let (before, first) = (earlier[axis][lane], earlier[axis + 3][lane]);
                    let now = &mut moved[axis * LANES + lane];
                    let [change, earlier] = [*now - before, before - first];
                    // What changes to and fro is no acceleration.
                    let steady = if change * earlier > 0.0 {
                        change.signum() * change.abs().min(earlier.abs())
                    } else {
                        0.0
                    };
                    *now = ratio * (*now + 0.5 * steady);
                }
            }
        }
    }

    /// Keeps displacements and makes them zero; what was known is forgotten.
    pub fn put_aside(&mut self, now: &mut [Block]) {
        self.is_known = false;
        self.blocks.resize(now.len(), Earlier::NONE);
        for (block, Earlier(kept)) in now.iter_mut().zip(&mut self.blocks) {
            for (moved, kept) in block.displacements_mut().chunks_exact_mut(LANES).zip(kept) {
                kept.copy_from_slice(moved);
                moved.fill(0.0);
            }
        }
    }

    /// Has displacements be what was kept of them.
    pub fn take_back(&mut self, now: &mut [Block]) {
        for (block, Earlier(kept)) in now.iter_mut().zip(&self.blocks) {
            for (moved, kept) in block.displacements_mut().chunks_exact_mut(LANES).zip(kept) {
                moved.copy_from_slice(kept);
            }
        }
    }

    /// The displacement of a particle in the sub-step before the last (m), if it is known.
    pub fn before(&self, slot: Slot) -> Option<Vec3> {
        let Earlier(earlier) = self.blocks.get(slot.block).filter(|_| self.is_known)?;
        Some(Vec3::from([0, 1, 2].map(|axis| earlier[axis][slot.lane])))
    }

    /// Applies `f` to the earlier displacements of a particle.
    pub fn change(&mut self, block: usize, lane: usize, f: impl Fn(Vec3) -> Vec3) {
        let Some(Earlier(earlier)) = self.blocks.get_mut(block) else {
            return;
        };
        for from in [0, 3] {
            let was = Vec3::from([0, 1, 2].map(|axis| earlier[from + axis][lane]));
            let is = f(was).to_array();
            for axis in 0..3 {
                earlier[from + axis][lane] = is[axis];
            }
        }
    }

    /// Becomes what `other` is, in the memory that it has.
    pub fn copy_from(&mut self, other: &Self) {
        self.blocks.clone_from(&other.blocks);
        (self.is_known, self.wait) = (other.is_known, other.wait);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a constant acceleration, the velocity is that at the end of the last displacement.
    #[test]
    fn what_is_left_of_a_past_is_its_velocity() {
        let mut past = Past::default();
        assert_eq!(past.next(1), StepKind::Start);
        past.blocks[0].0[0][3] = 1.0;
        past.blocks[0].0[4][3] = 1.0;
        let mut blocks = [Block::EMPTY];
        blocks[0].set_displacement(3, Vec3::new(2.0, 1.0, 0.0));
        past.restart(&mut blocks, 0.5);
        // Along x it is 1 faster in each sub-step, 2.5 at the end of the last; along y it goes to and fro.
        assert_eq!(blocks[0].displacement(3), Vec3::new(1.25, 0.5, 0.0));
        assert_eq!(past.next(1), StepKind::Start);
    }

    #[test]
    fn a_forgotten_past_is_waited_for_and_found_again() {
        let mut past = Past::default();
        let mut next = || past.next(1);
        assert_eq!(
            [next(), next(), next()],
            [StepKind::Start, StepKind::Second, StepKind::Second]
        );
        past.forget(3);
        let kinds: Vec<StepKind> = (0..6).map(|_| past.next(1)).collect();
        assert_eq!(kinds[..3], [StepKind::First; 3]);
        assert_eq!(
            kinds[3..],
            [StepKind::Start, StepKind::Second, StepKind::Second]
        );
        past.forget(0);
        assert_eq!(past.next(1), StepKind::Start);
    }
}
