//! Any triangle mesh is cloth.

mod alike;
mod drawn;
mod life;
mod pins;
mod refused;
pub mod sheets;
mod sources;
