//! Results of a top-down search.

use bevy::reflect::Reflect;

/// Results of searches, and memory for the next one.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
pub(crate) struct SearchBuffers {
    /// Nodes in the order of the tests, and whether they touched.
    pub visits: Vec<(u32, bool)>,
    /// Whether nobody reads the visits and the number of leaf tests, so that they need not be kept.
    pub is_silent: bool,
    /// Children of touching nodes on the current level, and on the next: their ranges of rows and of columns. For
    /// stored nodes, their range of indices.
    pub frontier: [Vec<[u32; 4]>; 2],
    pub candidates: Vec<u32>,
    pub leaf_tests: usize,
}
