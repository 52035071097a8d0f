//! The last sub-step in which layers were tested.

use super::{origin::Origin, participant::Participant};

/// While the approach of particles is less than this fraction of the thickness, pushed particles are held by the mean
/// of their last pushes, for this many sub-steps at most, and this fraction of the way.
const HELD: f32 = 0.08;
const LONGEST_HOLD: u32 = 8;
const PART_OF_WAY: f32 = 0.5;

/// The last sub-step in which pairs were tested.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct LastTest {
    /// Positions of all particles at its end: up to there, layers are apart. Whether they are of this tick.
    pub passed: Origin,
    pub is_of_tick: bool,
    /// Number of sub-steps since, and of those left without a test.
    pub waited: u32,
    pub wait: u32,
    /// Largest approach before others can touch (m).
    pub free: f32,
    /// The part of it that resting layers keep, to be held (m).
    pub reserve: f32,
}

impl LastTest {
    /// Takes over the positions of particles that are apart.
    pub fn pass(&mut self, cloths: &[Participant]) {
        self.passed.set(cloths);
        self.is_of_tick = true;
    }

    /// Begins a tick. Returns the approach of any two particles since (m).
    pub fn begin_tick(&mut self, cloths: &[Participant]) -> f32 {
        let approach = self.passed.approach(cloths);
        self.is_of_tick = approach == 0.0 && self.waited == 0;
        approach
    }

    /// Finds how far layers that touch may move before the next test, at this thickness and pace (m in a sub-step). Resting ones
    /// are held.
    pub fn hold(&mut self, thickness: f32, pace: f32, are_resting: bool) {
        let most = HELD * thickness;
        self.free = self.free.min(most);
        if are_resting {
            self.reserve = most.min(LONGEST_HOLD as f32 * pace / PART_OF_WAY);
            self.wait = ((PART_OF_WAY * self.free / pace) as u32).min(LONGEST_HOLD);
        }
    }
}
