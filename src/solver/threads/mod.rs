//! Threads of a grid, and of a mesh, solved exactly.
//!
//! The docs of the module [`solver`](crate::solver) describe the method, its cost and its limits.

mod again;
mod beside;
mod bundle;
mod bundles;
mod direction;
mod down;
mod ends;
mod grid;
mod link;
mod rows;
#[cfg(test)]
mod tests;
mod unsolved;

pub(super) use beside::Threads;
pub(super) use bundle::{Solved, Step, bundle_backward, bundle_forward};
pub(super) use bundles::Bundles;
pub(super) use down::{
    Columns, solve_columns, solve_columns_again, solve_damped_threads, solve_threads,
};
pub(super) use grid::ThreadSweep;
pub(super) use link::{Family, measure_given};
pub(super) use rows::{RowThreads, solve_damped_rows, solve_rows, solve_rows_again};
pub(super) use unsolved::{
    Left, RowSprings, measure_elastic_left, measure_elastic_left_at, measure_left, measure_left_at,
    note_places,
};
