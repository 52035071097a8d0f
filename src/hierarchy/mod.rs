//! Floor 1: how a cloth is *searched*: a quad-tree over the particles, bounding volumes, the top-down query.

mod bounds;
mod brute;
mod method;
mod probe;
mod query;
mod refit;
mod scan;
#[cfg(test)]
mod tests;
mod tree;
mod volume;

pub use bounds::{BoundRule, NodeBounds};
pub use brute::brute_force;
pub use method::{SEARCH_FROM, SearchMethod, SearchReason};
pub use probe::{Core, Probe};
pub use query::{NodeState, TopDownQuery};
pub use tree::{Node, QuadTree};
pub use volume::{BoundingVolume, KDop, NodeVolume, Obb};
