//! Directions of chains.

/// The direction of chains from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Direction {
    Down,
    /// A column further right in each row.
    Right,
    /// Likewise, but from the last row up: the same with the cloth upside down.
    Left,
}

impl Direction {
    /// The blocks of a row by which a chain is further right in the row of this number on its way than in the first.
    #[inline(always)]
    pub fn shift(self, number: usize, strip: usize) -> usize {
        match self {
            Self::Down => 0,
            Self::Right | Self::Left => number % strip,
        }
    }

    /// The row of this number on its way, of as many.
    #[inline(always)]
    pub fn row(self, number: usize, rows: usize) -> usize {
        match self {
            Self::Down | Self::Right => number,
            Self::Left => rows - 1 - number,
        }
    }
}
