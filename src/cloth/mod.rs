//! Floor 0: what a cloth *is*: its grid, particles, springs, material and pins.

mod error;
mod grid;
mod material;
mod particles;
mod pins;
mod springs;

pub use error::ClothError;
pub use grid::{Cloth, ClothGrid, MAX_PARTICLES};
pub use material::ClothMaterial;
pub use particles::{ClothParticles, ParticleId};
pub use pins::{Corner, Pin, Pins};
pub use springs::{Colour, SpringKind, Springs};
