//! The last springs of the strips of rows: what couples the lanes of a row to each other.

use crate::cloth::LANES;

/// Rows that are worked on at once: while one waits for its divisions, others need not.
pub(crate) const GROUP: usize = 8;

/// The lanes of all rows of a group, one after the other, and as many on either side as a step of the reduction looks at.
pub(crate) type Wide = [f32; BESIDE + GROUP * LANES + BESIDE];
pub(crate) const BESIDE: usize = 4;

/// The system for the last springs of strips. The last strip's leads nowhere: infinitely held, it takes nothing and hands on
/// nothing, so that rows need not be kept apart.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Reduced {
    pub diagonal: Wide,
    /// Coupling to the lane before.
    pub off: Wide,
    pub right: Wide,
    /// One over the diagonal.
    pub inverse: Wide,
}

impl Reduced {
    pub const NONE: Self = Self {
        diagonal: [1.0; _],
        off: [0.0; _],
        right: [0.0; _],
        inverse: [1.0; _],
    };

    /// Makes each lane independent of those `DISTANCE` away; with them comes what they have to do with those beyond.
    #[inline(always)]
    fn without<const DISTANCE: usize>(&self, out: &mut Self) {
        for at in BESIDE..BESIDE + GROUP * LANES {
            let (left, right) = (at - DISTANCE, at + DISTANCE);
            let before = self.off[at] * self.inverse[left];
            let after = self.off[right] * self.inverse[right];
            let diagonal = self.diagonal[at] - self.off[at] * before - self.off[right] * after;
            out.right[at] = self.right[at] - before * self.right[left] - after * self.right[right];
            out.off[at] = -before * self.off[left];
            out.diagonal[at] = diagonal;
            out.inverse[at] = 1.0 / diagonal;
        }
    }
}

/// The first and last springs of a group's strips.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Ends {
    /// Of the first particles (1/kg).
    pub weight: Wide,
    /// Of the first springs and of the last, in rest lengths.
    pub first: [Wide; 3],
    pub last: [Wide; 3],
    pub to_diagonal: Wide,
    pub to_right: Wide,
    /// Coupling of the first to the last of the strip before; then its share of that one's multiplier.
    pub off: Wide,
    /// Pull of the last ones (m kg).
    pub pull: [Wide; 3],
}

impl Ends {
    pub const NONE: Self = Self {
        weight: [0.0; _],
        first: [[0.0; _]; 3],
        last: [[0.0; _]; 3],
        to_diagonal: [0.0; _],
        to_right: [0.0; _],
        off: [0.0; _],
        pull: [[0.0; _]; 3],
    };

    /// Solves for the multipliers of the last springs, which are the right side then.
    #[inline(always)]
    pub fn solve(&mut self, [this, other]: &mut [Reduced; 2]) {
        for at in BESIDE..BESIDE + GROUP * LANES {
            let along = self.last[0][at - 1] * self.first[0][at]
                + self.last[1][at - 1] * self.first[1][at]
                + self.last[2][at - 1] * self.first[2][at];
            self.off[at] = -self.weight[at] * along;
            this.off[at] *= self.off[at];
        }
        for at in BESIDE..BESIDE + GROUP * LANES {
            let off = self.off[at + 1];
            let diagonal = this.diagonal[at] - off * (off * self.to_diagonal[at + 1]);
            this.diagonal[at] = diagonal;
            this.right[at] -= off * self.to_right[at + 1];
            this.inverse[at] = 1.0 / diagonal;
        }
        this.without::<1>(other);
        other.without::<2>(this);
        this.without::<4>(other);
        for at in BESIDE..BESIDE + GROUP * LANES {
            let multiplier = other.right[at] * other.inverse[at];
            this.right[at] = multiplier;
            self.pull[0][at] = self.last[0][at] * multiplier;
            self.pull[1][at] = self.last[1][at] * multiplier;
            self.pull[2][at] = self.last[2][at] * multiplier;
        }
        for at in BESIDE..BESIDE + GROUP * LANES {
            self.off[at] *= this.right[at - 1];
        }
    }
}
