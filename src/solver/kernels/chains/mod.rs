//! The arithmetic of chains of springs: forward and backward over tridiagonal systems.

mod beside;
mod bundle;
mod direction;
mod down;
mod ends;
mod link;
mod residuals;
mod rows;

pub(crate) use beside::{Chains, Scratch};
pub(crate) use bundle::{Solved, Step, bundle_backward, bundle_forward};
pub(crate) use direction::Direction;
pub(crate) use down::{
    Columns, solve_chains, solve_columns, solve_columns_again, solve_damped_chains,
};
pub(crate) use ends::GROUP;
pub(crate) use link::{SpringBand, measure_given};
pub(crate) use residuals::{
    Residuals, RowSprings, largest, measure_elastic_left, measure_elastic_left_at, measure_left,
    measure_left_at, note_places,
};
pub(crate) use rows::{RowChains, RowScratch, solve_damped_rows, solve_rows, solve_rows_again};
