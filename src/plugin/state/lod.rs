//! The current level of detail of a cloth, and when it is simulated.

use bevy::prelude::{Isometry3d, Vec3};

use crate::plugin::{authoring::ClothLodLevel, frame::Shift};

/// What happens to a cloth in a tick.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum LodAction {
    /// It is simulated.
    #[default]
    Move,
    /// It is simulated in a later tick, for the time of this one too.
    Wait,
    /// It stands still.
    Stand,
}

/// Places of a cloth as it froze, and of its carrier.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Frozen {
    /// The cloth's frame and its carrier as it froze.
    pub frame: Isometry3d,
    pub carrier: Isometry3d,
    /// Its carrier, a tick ago.
    pub last: Isometry3d,
}

/// The current level of detail of a cloth.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct LodState {
    pub level: ClothLodLevel,
    /// Number of distances that it has passed.
    pub passed: usize,
    pub action: LodAction,
    /// The time of ticks in which it waited (s).
    pub waited: f32,
    /// The number of these ticks, and the number of ticks until it is simulated, 1 for the coming one.
    pub ticks: u32,
    left: u32,
    /// Number of ticks that the last move took.
    moved_by: u32,
    /// Largest distance that a particle may have moved in that by itself (m).
    pub reach: f32,
    /// Ticks since it was last moved, and ticks from then until it is moved again, over which the move is drawn.
    pub since: u32,
    span: u32,
    /// Changes whenever its picture would jump.
    pub cuts: u32,
    pub frozen: Option<Frozen>,
    /// Remaining ticks at full rate, because something that moves is or was near.
    pub kept: u32,
    /// From a snapshot: centre and radius of a sphere around it, in its frame (m), since nothing is built yet where it
    /// is restored.
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

    /// Number of ticks that the last move took.
    pub fn moved_by(&self) -> u32 {
        self.moved_by.max(1)
    }

    /// Whether it is moved in the coming tick, if it is at its level.
    pub fn is_due(&self) -> bool {
        self.left <= 1
    }

    /// Begins a tick of `seconds` at `level`. Cloths of the same level and of different `phase` are moved in different
    /// ticks. `is_due` moves it now in any case. A cloth that `rests` is looked at in each tick, since it does not
    /// move.
    pub fn begin(
        &mut self,
        level: ClothLodLevel,
        (phase, is_due, rests): (u32, bool, bool),
        seconds: f32,
    ) {
        let was = std::mem::replace(&mut self.level, level);
        let ticks = level.ticks().map(|ticks| if rests { 1 } else { ticks });
        let Some(ticks) = ticks else {
            if self.action != LodAction::Stand {
                self.cuts = self.cuts.wrapping_add(1);
            }
            self.action = LodAction::Stand;
            (self.waited, self.ticks) = (0.0, 0);
            return;
        };
        // While no time passes, nothing changes.
        if seconds == 0.0 {
            self.level = was;
            return;
        }
        let has_stood = self.action == LodAction::Stand;
        if !(is_due || rests || has_stood || was != level || self.left <= 1) {
            self.action = LodAction::Wait;
            self.waited += seconds;
            self.ticks += 1;
            self.left -= 1;
            self.since += 1;
            return;
        }
        let first = 1 + phase % ticks;
        let left = if was == level { ticks } else { first };
        // A cloth that is moved before its picture has reached the last move would jump there; one whose picture is
        // less late than before would jump ahead.
        if has_stood || self.since + 1 < self.span || self.ticks + 1 > left {
            self.cuts = self.cuts.wrapping_add(1);
        }
        self.action = LodAction::Move;
        (self.left, self.since, self.span) = (left, 0, left);
    }

    /// The fraction of the last move that is drawn this number of ticks after it; all of it as the next move comes. It
    /// grows at the speed of the motion, or slower if the move took fewer ticks than there are until the next.
    #[cfg(any(feature = "mesh", test))]
    pub fn drawn_part(&self, ticks: f32) -> f32 {
        let (moved_by, span) = (self.moved_by.max(1) as f32, self.span.max(1) as f32);
        let skipped = (moved_by - span).max(0.0) / moved_by;
        skipped + (1.0 - skipped) * (ticks / span).min(1.0)
    }

    /// Takes the time that it is moved by in a tick of `seconds` (s), and the number of ticks in that.
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
                match state.action {
                    LodAction::Move => state.take(TICK).0,
                    LodAction::Wait | LodAction::Stand => 0.0,
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

    /// A cloth at rest is looked at in each tick, even at a lower rate, and drawn as it is.
    #[test]
    fn what_rests_is_not_cut() {
        let mut state = LodState::default();
        moved(&mut state, Every(4), 3, 3);
        for _ in 0..8 {
            state.begin(Every(4), (3, false, true), TICK);
            assert_eq!((state.action, state.cuts), (LodAction::Move, 1));
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
