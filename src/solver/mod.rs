//! Floor 1: how a cloth *moves*: threads solved exactly, and a motion of second order in time, in small sub-steps.
//!
//! A tick is cut into sub-steps of Δt (small steps instead of many sweeps: Macklin et al. 2019). Each predicts where every
//! particle would be by itself, by backward differences of second order or by the paper's equation (2), bends it back as a plate
//! would, and then holds the rest lengths of the springs, which are XPBD constraints (Macklin et al. 2016): thread by thread,
//! each solved as one system of equations.

mod bands;
mod barrier;
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
