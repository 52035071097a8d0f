//! The springs of a grid, and of a mesh, solved chain by chain.
//!
//! The docs of the module [`solver`](crate::solver) describe the method, its cost and its limits.

mod bands;
mod bundles;
mod grid;
mod second_pass;
#[cfg(test)]
mod tests;

pub(crate) use bundles::Bundles;
pub(crate) use grid::GridSolver;
