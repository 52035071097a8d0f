//! What a top-down search finds.

use bevy::reflect::Reflect;

/// What searches have found, and memory for the next one.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
pub(crate) struct Found {
    /// Nodes in the order in which they were looked at, and whether they touched.
    pub visits: Vec<(u32, bool)>,
    /// Children of touching nodes on the level that is looked at, and on the next: from and to which row, from and to
    /// which column; of nodes that are stored one by one, from and to which.
    pub frontier: [Vec<[u32; 4]>; 2],
    pub candidates: Vec<u32>,
    pub leaf_tests: usize,
}
