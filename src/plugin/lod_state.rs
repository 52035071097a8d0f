//! At which level of detail a cloth is, and when it is moved.

use bevy::math::{Isometry3d, Vec3};

use super::{frame::Shift, lod::ClothLodLevel};

/// What becomes of a cloth in a tick.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Turn {
    /// It is moved.
    #[default]
    Move,
    /// It is moved in a later tick, by the time of this one too.
    Wait,
    /// It stands still.
    Stand,
}

/// Where a cloth was as it froze, and what carries it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Frozen {
    /// The cloth's frame as it froze, and what carried it then.
    pub frame: Isometry3d,
    pub carrier: Isometry3d,
    /// What carries it, a tick ago.
    pub last: Isometry3d,
}

/// The level of detail that a cloth is at.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct LodState {
    pub level: ClothLodLevel,
    /// How many distances it has passed.
    pub passed: usize,
    pub turn: Turn,
    /// The time of ticks in which it waited (s).
    pub waited: f32,
    /// How many these are, and in how many ticks it is moved, the coming one being 1.
    pub ticks: u32,
    left: u32,
    /// Of how many ticks the last move was.
    moved_by: u32,
    /// How far a particle may have got in that by itself (m).
    pub reach: f32,
    /// Ticks since it was moved, and how many there are from then until it is moved again: over as many it is drawn.
    pub since: u32,
    span: u32,
    /// New whenever what is drawn of it would jump.
    pub cuts: u32,
    pub frozen: Option<Frozen>,
    /// For how many ticks it is kept from a lower rate: something that moves is or was near.
    pub kept: u32,
    /// Of a snapshot: middle and radius of a sphere around it, in its frame (m), as nothing is built yet where it is restored.
    pub sphere: Option<(Vec3, f32)>,
}

impl Frozen {
    /// After a jump of the world's origin, what carries it being at `now`.
    pub fn shifted(self, shift: Shift, now: Option<Isometry3d>) -> Self {
        Self {
            frame: shift.rigid(self.frame, None),
            carrier: shift.rigid(self.carrier, now),
            last: shift.rigid(self.last, now),
        }
    }
}

impl LodState {
    /// Whether a cloth without a level of detail of its own would be as it is.
    pub fn is_full(&self) -> bool {
        self.level == ClothLodLevel::Full && self.waited == 0.0 && self.span <= 1
    }

    /// Of how many ticks the last move was.
    pub fn moved_by(&self) -> u32 {
        self.moved_by.max(1)
    }

    /// Whether it is moved in the coming tick, if it is at its level.
    pub fn is_due(&self) -> bool {
        self.left <= 1
    }

    /// Begins a tick of `seconds` at `level`: of cloths of the same level those of different `phase` are moved in different
    /// ones. `is_due` moves it now in any case, and what `rests` is looked at in each tick: it does not move.
    pub fn begin(
        &mut self,
        level: ClothLodLevel,
        (phase, is_due, rests): (u32, bool, bool),
        seconds: f32,
    ) {
        let was = std::mem::replace(&mut self.level, level);
        let ticks = level.ticks().map(|ticks| if rests { 1 } else { ticks });
        let Some(ticks) = ticks else {
            if self.turn != Turn::Stand {
                self.cuts = self.cuts.wrapping_add(1);
            }
            self.turn = Turn::Stand;
            (self.waited, self.ticks) = (0.0, 0);
            return;
        };
        // While no time passes, it goes on as it is.
        if seconds == 0.0 {
            self.level = was;
            return;
        }
        let has_stood = self.turn == Turn::Stand;
        if !(is_due || rests || has_stood || was != level || self.left <= 1) {
            self.turn = Turn::Wait;
            self.waited += seconds;
            self.ticks += 1;
            self.left -= 1;
            self.since += 1;
            return;
        }
        let left = if was == level {
            ticks
        } else {
            1 + phase % ticks
        };
        // What is moved before it is drawn where the last move left it would jump there, and what is drawn less late than before
        // would jump ahead.
        if has_stood || self.since + 1 < self.span || self.ticks + 1 > left {
            self.cuts = self.cuts.wrapping_add(1);
        }
        self.turn = Turn::Move;
        (self.left, self.since, self.span) = (left, 0, left);
    }

    /// The part of the last move that is drawn, so many ticks after it: all of it as the next one comes, at the speed at which it
    /// moves or, where it was by fewer ticks than there are until then, slower.
    #[cfg(any(feature = "mesh", test))]
    pub fn drawn_part(&self, ticks: f32) -> f32 {
        let (moved_by, span) = (self.moved_by.max(1) as f32, self.span.max(1) as f32);
        let skipped = (moved_by - span).max(0.0) / moved_by;
        skipped + (1.0 - skipped) * (ticks / span).min(1.0)
    }

    /// Takes the time to be moved by in a tick of `seconds` (s), and how many ticks that is of.
    pub fn take(&mut self, seconds: f32) -> (f32, u32) {
        let waited = std::mem::take(&mut self.waited);
        self.moved_by = std::mem::take(&mut self.ticks) + 1;
        (waited + seconds, self.moved_by)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ClothLodLevel::{Every, Frozen, Full};

    const TICK: f32 = 0.25;

    /// The seconds that each tick moves a cloth by; none where it waits.
    fn moved(state: &mut LodState, level: ClothLodLevel, phase: u32, ticks: usize) -> Vec<f32> {
        (0..ticks)
            .map(|_| {
                state.begin(level, (phase, false, false), TICK);
                match state.turn {
                    Turn::Move => state.take(TICK).0,
                    Turn::Wait | Turn::Stand => 0.0,
                }
            })
            .collect()
    }

    #[test]
    fn no_time_is_lost_and_phases_differ() {
        let mut state = LodState::default();
        assert_eq!(moved(&mut state, Full, 0, 3), [TICK; 3]);
        assert_eq!(
            moved(&mut state, Every(3), 1, 7),
            [0.25, 0.0, 0.5, 0.0, 0.0, 0.75, 0.0]
        );
        assert_eq!(
            moved(&mut state, Full, 1, 2),
            [0.5, 0.25],
            "with what it waited"
        );
        let mut other = LodState::default();
        assert_eq!(
            moved(&mut other, Every(3), 2, 5),
            [0.25, 0.0, 0.0, 0.75, 0.0]
        );
        assert_eq!(moved(&mut other, Frozen, 2, 2), [0.0; 2]);
        assert_eq!(
            moved(&mut other, Full, 2, 2),
            [TICK; 2],
            "frozen time does not pass"
        );
    }

    #[test]
    fn is_drawn_as_fast_as_it_moves() {
        let mut state = LodState::default();
        moved(&mut state, Full, 0, 1);
        assert_eq!(
            [0.0, 0.25, 1.0].map(|ticks| state.drawn_part(ticks)),
            [0.0, 0.25, 1.0]
        );
        moved(&mut state, Every(4), 3, 5);
        assert_eq!(
            [0.0, 2.0, 4.0].map(|ticks| state.drawn_part(ticks)),
            [0.0, 0.5, 1.0]
        );
        moved(&mut state, Full, 3, 1);
        // By three ticks at once, of which two are past where it is drawn a tick late.
        moved(&mut state, Every(4), 3, 7);
        moved(&mut state, Full, 3, 1);
        for (ticks, part) in [(0.0, 2.0 / 3.0), (0.5, 2.5 / 3.0), (1.0, 1.0)] {
            let off = state.drawn_part(ticks) - part;
            assert!(off.abs() < 1.0e-6, "{off} after {ticks} ticks");
        }
    }

    /// What rests at a lower rate is looked at in each tick, and drawn as it is.
    #[test]
    fn what_rests_is_not_cut() {
        let mut state = LodState::default();
        moved(&mut state, Every(4), 3, 3);
        for _ in 0..8 {
            state.begin(Every(4), (3, false, true), TICK);
            assert_eq!((state.turn, state.cuts), (Turn::Move, 1));
            state.take(TICK);
        }
        assert_eq!(state.drawn_part(1.0), 1.0);
        assert_eq!(
            moved(&mut state, Every(4), 3, 5),
            [0.25, 0.0, 0.0, 0.0, 1.0]
        );
    }

    /// Between moves the picture takes as many ticks as there are to the next move, and is cut only where it is moved before.
    #[test]
    fn is_drawn_over_the_ticks_to_the_next_move() {
        let mut state = LodState::default();
        let mut run = |level, ticks| {
            moved(&mut state, level, 1, ticks);
            (state.since, state.span, state.cuts)
        };
        assert_eq!(run(Full, 2), (0, 1, 0));
        assert_eq!(run(Every(4), 1), (0, 2, 0));
        assert_eq!(run(Every(4), 1), (1, 2, 0));
        assert_eq!(run(Every(4), 1), (0, 4, 0));
        assert_eq!(run(Every(4), 2), (2, 4, 0));
        assert_eq!(run(Full, 1), (0, 1, 1), "a tick before its time");
        assert_eq!(run(Frozen, 3), (0, 1, 2));
        assert_eq!(run(Full, 1), (0, 1, 3));
    }
}
