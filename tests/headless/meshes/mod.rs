//! Any triangle mesh is cloth.

mod alike;
pub mod drawn;
mod life;
mod pins;
mod refused;
pub mod sheets;
mod sources;
