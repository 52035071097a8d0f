//! The first stage of a tick: checks every input, and takes it over.
//!
//! In: the game's components, transforms, meshes, cameras. Out: [`ClothBuilt`](crate::plugin::ClothBuilt) of what is new,
//! the step of each cloth in [`ClothScratch`](crate::plugin::ClothScratch), the motion of each collider, the wind, the
//! islands of cloths that may touch, or a [`ClothFault`](crate::plugin::ClothFault).

mod asleep;
mod attach;
mod broad_phase;
mod build;
mod build_inputs;
mod carry;
mod cloths;
mod colliders;
mod follow;
mod freeze;
mod grabs;
mod islands;
mod levels;
mod named;
mod neighbour;
mod notice;
mod preparing;
mod resample;
mod roots;
mod seams;
mod skin;
mod source;
mod step;
mod tears;
mod wind;

pub(crate) use broad_phase::cover;
pub(crate) use carry::FAR;
pub(crate) use cloths::prepare_cloths;
pub(crate) use colliders::{
    ChangedColliders, ColliderMemory, ColliderMotion, ColliderTree, forget_collider, note_enabled,
    note_removals, prepare_colliders,
};
pub(crate) use grabs::{hold_cloths, let_go};
pub(crate) use islands::{Island, Islands, find_islands};
pub(crate) use levels::choose_levels;
pub(crate) use roots::{Teleporting, follow_roots};
pub(crate) use seams::{Seams, forget_stitches, prepare_seams};
pub(crate) use source::Skins;
#[cfg(feature = "mesh")]
pub(crate) use source::{ChangedMeshes, SharedMeshes, not_there, note_changed_meshes};
pub(crate) use tears::build_torn_ahead;
pub(crate) use wind::prepare_wind;
