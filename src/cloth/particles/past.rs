//! What particles remember of their motion, for a method of second order.

use crate::cloth::{Block, LANES, Lanes};

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

    /// Has all displacements, those of `now` with them, span a sub-step that is `ratio` times as long: the motion of third
    /// degree through the four places that are known stays the same. Returns whether it did: not if they are not known, or
    /// are too far from the new ones.
    pub fn rescale(&mut self, now: &mut [Block], ratio: f32) -> bool {
        if !self.is_known || self.blocks.len() != now.len() || !(0.25..=2.0).contains(&ratio) {
            return false;
        }
        let rows = resampling(f64::from(ratio)).map(|row| row.map(|number| number as f32));
        for (block, Earlier(earlier)) in now.iter_mut().zip(&mut self.blocks) {
            let moved = block.displacements_mut();
            for axis in 0..3 {
                for lane in 0..LANES {
                    let was = [
                        moved[axis * LANES + lane],
                        earlier[axis][lane],
                        earlier[axis + 3][lane],
                    ];
                    let of = |row: &[f32; 3]| row[0] * was[0] + row[1] * was[1] + row[2] * was[2];
                    moved[axis * LANES + lane] = of(&rows[0]);
                    earlier[axis][lane] = of(&rows[1]);
                    earlier[axis + 3][lane] = of(&rows[2]);
                }
            }
        }
        true
    }

    /// Applies `f` to the earlier displacements of a particle.
    pub fn change(
        &mut self,
        block: usize,
        lane: usize,
        f: impl Fn(bevy::math::Vec3) -> bevy::math::Vec3,
    ) {
        let Some(Earlier(earlier)) = self.blocks.get_mut(block) else {
            return;
        };
        for from in [0, 3] {
            let was = bevy::math::Vec3::from([0, 1, 2].map(|axis| earlier[from + axis][lane]));
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

/// How the last three displacements over a step follow from those over another, `ratio` times as long: both are differences
/// of the cubic through four places (Newton's backward differences).
fn resampling(ratio: f64) -> [[f64; 3]; 3] {
    // The place at s steps from now, as a sum of displacements.
    let place = |s: f64| {
        let [first, second, third] = [s, s * (s + 1.0) / 2.0, s * (s + 1.0) * (s + 2.0) / 6.0];
        [first + second + third, -second - 2.0 * third, third]
    };
    [0.0, 1.0, 2.0].map(|back| {
        let (now, before) = (place(-back * ratio), place(-(back + 1.0) * ratio));
        [0, 1, 2].map(|at| now[at] - before[at])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = t³ + t² − t: its displacements over steps of 1 become those over steps of any other length.
    #[test]
    fn a_cubic_motion_is_the_same_in_other_steps() {
        let place = |t: f64| t * t * t + t * t - t;
        let displacements = |step: f64| {
            [0.0, 1.0, 2.0].map(|back| place(-back * step) - place(-(back + 1.0) * step))
        };
        let was = displacements(1.0);
        for ratio in [0.25, 0.5, 0.9, 1.0, 1.3, 2.0] {
            let is = displacements(ratio);
            for (row, expected) in resampling(ratio).iter().zip(is) {
                let found: f64 = row.iter().zip(was).map(|(a, b)| a * b).sum();
                assert!(
                    (found - expected).abs() < 1.0e-12,
                    "{ratio}: {found} {expected}"
                );
            }
        }
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
