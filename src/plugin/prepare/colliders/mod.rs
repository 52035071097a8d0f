//! Follows the colliders from tick to tick.
//!
//! In: `ClothCollider`, `ClothBody`, transforms. Out: the motion of each collider, and the tree of their bounds.

mod built;
mod changes;
mod follow;
mod motion;
mod skinned;
mod stay;
mod tree;

pub(crate) use changes::{ChangedColliders, note_enabled, note_removals};
pub(crate) use follow::{forget_collider, prepare_colliders};
pub(crate) use motion::{ColliderMemory, ColliderMotion};
pub(crate) use tree::ColliderTree;
