//! Floor 1: how a cloth *moves*: Verlet integration and distance constraints in small sub-steps.
//!
//! A tick is cut into sub-steps of Δt. Each moves every particle by the paper's equation (2) and then sweeps
//! once over the springs, which as XPBD constraints hold their rest lengths (Macklin et al. 2016; small steps
//! instead of many sweeps: Macklin et al. 2019). With one sweep a sub-step no multiplier needs storing.

mod bands;
mod bending;
mod envelope;
mod kernel;
mod list;
#[cfg(feature = "methods")]
#[doc(hidden)]
pub mod methods;
mod packet;
mod pipeline;
mod plate;
mod predict;
mod rest;
mod run;
mod settings;
mod spin;
mod step;
mod stretch;
mod substep;
mod substepping;
mod sweep;
#[cfg(test)]
mod tests;
mod tether;
mod thread;
mod threads;

pub use bending::Bending;
pub use envelope::ClothLimit;
pub(crate) use envelope::LimitInputs;
#[doc(hidden)]
pub use kernel::SimdLevel;
pub use rest::Rest;
pub use settings::ClothSettings;
pub use step::{PinMotion, SubStep, TickStep, TimeOrder};
pub use stretch::Stretch;
pub use substep::Solver;
pub use substepping::{Control, Substepping};
pub use tether::Tethers;
pub(crate) use tether::material_stretch;
