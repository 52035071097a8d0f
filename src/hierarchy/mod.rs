//! Floor 1: how a cloth is *searched*: a quad-tree over the grid, bounding spheres, the top-down query.
//!
//! The tree halves the grid's index rectangle in both directions until a leaf holds one particle. It depends
//! on the grid alone and is built once. What changes is where each node's sphere is ([`BoundRule`]).

mod bounds;
mod brute;
mod query;
#[cfg(test)]
mod tests;
mod tree;

pub use bounds::{BoundRule, SphereBounds};
pub use brute::brute_force;
pub use query::{NodeState, Probe, TopDownQuery};
pub use tree::{Node, QuadTree};
