//! Bodies with a mass, which cloth pushes back, and the particles that carry them between sub-steps.

mod body;
mod carriers;

pub use body::BodyChange;
pub(crate) use body::{Before, Body};
pub(crate) use carriers::{Carrier, Carriers};
