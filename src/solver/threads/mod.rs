//! Threads of a grid, and of a mesh, solved exactly.
//!
//! What that is, what it costs and where it fails is in the docs of the module [`solver`](crate::solver).

mod beside;
mod bundle;
mod bundles;
mod direction;
mod down;
mod grid;
mod link;
mod rows;
mod systems;
#[cfg(test)]
mod tests;

pub(super) use bundle::{Solved, Step, bundle_backward, bundle_forward};
pub(super) use bundles::Bundles;
pub(super) use down::{
    Pull, clear, column_backward, column_forward, column_heads, left_backward, left_forward,
    left_heads, right_backward, right_forward,
};
pub(super) use grid::ThreadSweep;
pub(super) use link::{Family, Link, measure_given};
pub(super) use rows::{Rows, pull_row, row_equations, solve_turned, turn_back, turn_terms};
