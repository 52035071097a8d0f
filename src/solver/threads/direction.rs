//! Where threads lead.

/// Where threads lead that go from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Direction {
    Down,
    Right,
    Left,
}
