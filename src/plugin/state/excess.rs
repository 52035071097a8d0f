//! The excess of a cloth over a limit, and its duration.

use crate::solver::ClothLimit;

/// Ticks in a row before a report: a blow may stretch a cloth for an instant, which does no harm.
const TICKS: u32 = 8;

/// A quantity that becomes this many times as large as reported is reported again.
const WORSE: f32 = 10.0;

/// The excess of a cloth over a limit.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Excess {
    /// Number of ticks in a row.
    ticks: u32,
    /// The quantity that was reported, 0 before that.
    reported: f32,
}

impl Excess {
    /// Takes the quantity of a tick, if it was beyond the limit then. Returns whether to report it.
    pub fn observe(&mut self, limit: ClothLimit, quantity: Option<f32>) -> bool {
        let Some(quantity) = quantity else {
            self.ticks = 0;
            return false;
        };
        self.ticks = self.ticks.saturating_add(1);
        // A collider passes through in a single tick, and a tolerance holds in each tick or not at all.
        let is_at_once = matches!(
            limit,
            ClothLimit::SmallFastCollider
                | ClothLimit::Tolerance
                | ClothLimit::Layers
                | ClothLimit::Embedded
        );
        let lasts = self.ticks >= TICKS || is_at_once;
        let is_reported = self.reported == 0.0 || quantity >= WORSE * self.reported;
        if lasts && is_reported {
            self.reported = quantity;
        }
        lasts && is_reported
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: ClothLimit = ClothLimit::Stretch;

    #[test]
    fn is_reported_after_eight_ticks_and_again_when_ten_times_worse() {
        let mut excess = Excess::default();
        let mut observe = |quantity| excess.observe(LIMIT, quantity);
        assert!((1..TICKS).all(|_| !observe(Some(0.2))));
        assert!(observe(Some(0.2)));
        assert!(!observe(Some(1.9)));
        assert!(!observe(None));
        assert!((1..TICKS).all(|_| !observe(Some(2.1))), "an instant again");
        assert!(observe(Some(2.1)));
        assert!(!observe(Some(2.2)));
    }
}
