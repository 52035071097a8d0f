//! Floor 0: what a cloth *is*: its grid, particles, springs, material and pins.

mod error;
mod grid;
mod lanes;
mod material;
mod particles;
mod pins;
mod presence;
mod springs;

pub use error::ClothError;
pub use grid::{Cloth, ClothGrid, ClothPlane, MAX_PARTICLES};
pub use material::ClothMaterial;
pub use particles::{ClothParticles, ParticleId};
pub use pins::{Corner, Pin, PinPredicate, Pins};
pub use springs::{Spring, SpringKind, Springs};

pub(crate) use lanes::{Block, DX, DY, DZ, LANES, Lanes, Layout, Slot, View, W, X, Y, Z};
pub(crate) use presence::ClothPresence;
pub(crate) use springs::{Compliances, Weave, rest_length};
