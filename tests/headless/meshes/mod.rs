//! Any triangle mesh is cloth.

mod alike;
mod drawn;
mod pins;
mod refused;
mod sheets;
mod sources;
