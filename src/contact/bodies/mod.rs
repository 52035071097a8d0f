//! Bodies with a mass, which cloth pushes back, the particles that carry them between sub-steps, and bodies that stand on
//! cloth which lies on something.

mod body;
mod carriers;
mod standing;

pub(crate) use body::Body;
pub use body::BodyChange;
pub(crate) use carriers::{Carrier, Carriers};
pub(crate) use standing::{ContactStep, Near, Stand, StandingResponse, Supports};
