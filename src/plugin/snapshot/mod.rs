//! What a cloth, or a world of cloths and colliders, goes on from: taken between two ticks, and put back.

mod cloth;
mod error;
mod world;

pub use cloth::ClothSnapshot;
pub use error::SnapshotError;
pub use world::ClothWorldSnapshot;
