//! The narrow phase by triangles, for colliders that would slip between particles.

mod corners;
mod faces;
mod friction;
mod grid;
mod lanes;

pub use corners::meets_triangles;
pub(crate) use corners::{CoreMotion, Corners};
pub(crate) use faces::{ResumePoint, TrianglePush};
#[cfg(test)]
pub(crate) use friction::{CapsuleCore, hold_all, hold_all_baseline};
#[cfg(test)]
pub(crate) use grid::{Place, push_cells, push_cells_baseline};
#[cfg(test)]
pub(crate) use lanes::{Cells, nearest_of_each};
