//! History of the particles' motion, for a second-order method.

use bevy::math::Vec3;

use crate::cloth::arrays::MapInline;
use crate::cloth::lanes::{Block, LANES, Lanes, Layout, Slot};

/// The displacements of eight particles in the two sub-steps before the last (m): x, y and z of the later one, then of
/// the earlier one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[repr(C, align(64))]
pub(crate) struct Earlier(pub [Lanes; 6]);

impl Earlier {
    const NONE: Self = Self([[0.0; LANES]; 6]);

    /// The displacement of a particle in the sub-step before the last (m).
    pub fn before(&self, lane: usize) -> Vec3 {
        Vec3::from([0, 1, 2].map_inline(|axis| self.0[axis][lane]))
    }

    /// The change of a particle's displacement from the earlier of these sub-steps to the later (m).
    pub fn gain(&self, lane: usize) -> Vec3 {
        Vec3::from([0, 1, 2].map_inline(|axis| self.0[axis][lane] - self.0[axis + 3][lane]))
    }
}

/// Displacements in earlier sub-steps.
#[derive(Debug, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Past {
    /// One entry for each block; empty for a first-order method.
    pub blocks: Vec<Earlier>,
    /// Whether they are known.
    is_known: bool,
    /// Number of coming sub-steps in which the history is ignored.
    wait: u32,
    /// Whether there was a tick before.
    has_moved: bool,
    /// Set after a change to shorter sub-steps.
    watch: Watch,
}

/// Ticks in which springs that were left stretched pull back.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Watch {
    /// Ticks left.
    ticks: u32,
    /// Energy lost in earlier ticks, which may return (J).
    lost: f64,
}

/// The order of a sub-step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StepKind {
    /// Implicit Euler.
    First,
    /// The first step of second order, from position and velocity alone.
    Start,
    /// BDF2.
    Second,
}

impl Past {
    /// Forgets everything but the velocity, without first-order steps.
    pub fn end(&mut self, now: &mut [Block]) {
        self.restart(now, 1.0);
        self.wait = 0;
        self.watch = Watch::default();
    }

    /// Forgets everything, and takes this many first-order sub-steps first.
    pub fn forget(&mut self, wait: u32) {
        self.is_known = false;
        self.wait = self.wait.max(wait);
    }

    /// Whether the coming sub-step ignores it: something pushed the cloth, or its springs were left stretched.
    pub fn is_ignored(&self) -> bool {
        self.wait > 0
    }

    /// The order of the coming sub-step, if second order is enabled.
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

    /// Forgets everything but the velocity, and rescales displacements to a sub-step `ratio` times as long. Second
    /// order where the history is known.
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
                    // Alternating changes are not an acceleration.
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

    /// Block by block, if displacements are known.
    pub fn known(&self) -> Option<&[Earlier]> {
        self.is_known.then_some(&self.blocks)
    }

    /// Watches this many ticks from the next one on, if there was motion before.
    pub fn watch(&mut self, ticks: u32) {
        if self.has_moved {
            self.watch.ticks = ticks;
        }
    }

    /// Marks that a tick has passed.
    pub fn set_moved(&mut self) {
        self.has_moved = true;
    }

    /// Energy that may return in the coming tick (J), if that tick is watched. Uses up one watched tick.
    pub fn next_watched(&mut self) -> Option<f64> {
        if self.watch.ticks == 0 {
            self.watch.lost = 0.0;
            return None;
        }
        self.watch.ticks -= 1;
        Some(self.watch.lost)
    }

    /// Energy that may return (J).
    #[cfg(test)]
    pub fn lost(&self) -> f64 {
        self.watch.lost
    }

    /// Sets the energy that may return (J).
    pub fn set_lost(&mut self, lost: f64) {
        self.watch.lost = lost;
    }

    /// Applies `f` to the earlier displacements of a particle.
    pub fn change(&mut self, block: usize, lane: usize, f: impl Fn(Vec3) -> Vec3) {
        let Some(Earlier(earlier)) = self.blocks.get_mut(block) else {
            return;
        };
        for from in [0, 3] {
            let was = Vec3::from([0, 1, 2].map_inline(|axis| earlier[from + axis][lane]));
            let is = f(was).to_array();
            for axis in 0..3 {
                earlier[from + axis][lane] = is[axis];
            }
        }
    }

    /// The same for other particles, each with the past of its parent.
    pub fn of_parents(&self, parents: impl Iterator<Item = Slot>, to: Layout) -> Self {
        let mut blocks = Vec::new();
        if !self.blocks.is_empty() {
            blocks.resize(to.blocks(), Earlier::NONE);
            for (old, slot) in parents.zip(to.slots()) {
                for axis in 0..6 {
                    blocks[slot.block].0[axis][slot.lane] =
                        self.blocks[old.block].0[axis][old.lane];
                }
            }
        }
        Self { blocks, ..*self }
    }

    /// Copies `other` into the existing allocation.
    pub fn copy_from(&mut self, other: &Self) {
        let mut blocks = std::mem::take(&mut self.blocks);
        blocks.clone_from(&other.blocks);
        *self = Self { blocks, ..*other };
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

    #[test]
    fn what_never_moved_is_not_watched() {
        let mut past = Past::default();
        past.watch(2);
        assert_eq!(past.next_watched(), None);
        past.set_moved();
        past.watch(2);
        assert_eq!(past.next_watched(), Some(0.0));
        past.set_lost(3.0);
        assert_eq!(
            [past.next_watched(), past.next_watched()],
            [Some(3.0), None]
        );
        past.watch(1);
        assert_eq!(past.next_watched(), Some(0.0), "another change");
    }
}
