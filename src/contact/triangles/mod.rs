//! The narrow phase by triangles, for colliders that would slip between particles.

mod corners;
mod faces;
mod friction;
mod grid;
mod lanes;
mod triangle;

pub use corners::meets_triangles;
pub(crate) use corners::{CoreMotion, Corners};
pub(crate) use faces::{ResumePoint, TrianglePush};
#[cfg(test)]
pub(crate) use friction::{CapsuleCore, hold_all, hold_all_baseline};
#[cfg(test)]
pub(crate) use grid::{Place, push_cells, push_cells_baseline};
#[cfg(test)]
pub(crate) use lanes::{Cells, nearest_of_each};
#[cfg(test)]
pub(crate) use triangle::area_within;
pub(crate) use triangle::{at, nearest, nearest_of_segments, nearest_to_point};
