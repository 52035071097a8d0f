//! Snapshots of a cloth, or of a world of cloths and colliders, taken and restored between two ticks.

mod cloth;
mod error;
mod world;

pub use cloth::ClothSnapshot;
pub use error::SnapshotError;
pub use world::ClothWorldSnapshot;
