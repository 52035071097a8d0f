//! The solver against what is true: closed forms, conservation, a converged run in f64. `-- --nocapture` prints
//! the figures.

mod catenary;
mod compliance;
mod distance;
mod energy;
mod mesh;
mod precision;
mod scenes;
mod strip;
