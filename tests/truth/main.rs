//! The solver against what is true: closed forms, conservation, a converged run in f64. `-- --nocapture` prints
//! the figures.

mod catenary;
mod compliance;
mod distance;
mod energy;
#[path = "../../examples/shared/modes.rs"]
mod modes;
mod precision;
mod scenes;
#[path = "../../examples/shared/sheet.rs"]
mod sheet;
mod strip;
mod swings;
