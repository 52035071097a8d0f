//! The solver against what is true: closed forms, conservation, a converged run in f64. `-- --nocapture` prints
//! the figures.

mod bending;
mod catenary;
mod compliance;
mod distance;
mod energy;
mod precision;
mod scenes;
mod strip;
