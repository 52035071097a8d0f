//! Components and resources that the plugin keeps for each cloth, and for the world.
//!
//! [`ClothState`] is the memory from tick to tick, [`ClothBuilt`] is built from the game's components, [`ClothScratch`]
//! is handed from stage to stage within a tick. Stages write them; nothing here is a system, except for the log of notices.

mod async_build;
mod built;
mod contacts;
mod fault;
mod forces;
mod inputs;
mod lod;
mod memory;
mod notices;
mod parts;
mod pieces;
mod pose;
mod recipe;
mod resting;
mod scratch;
mod search;
mod shared;
mod shared_parts;
mod stats;
mod wind_field;

pub(crate) use async_build::BuildRequest;
pub use built::ClothBuilt;
pub(crate) use built::{BuiltFrom, Changes, FailedBuild};
pub use contacts::{ClothContact, ClothContacts, ClothTouchStarted, ClothTouchStopped};
pub use fault::ClothFault;
pub(crate) use forces::GameForces;
pub(crate) use inputs::{GameQuery, Inputs};
pub(crate) use lod::{Frozen, LodAction};
pub use memory::ClothState;
pub(crate) use notices::{Notices, log_notices};
pub(crate) use parts::{ClothParts, OwnParts};
pub(crate) use pose::{Pose, SkinLimits};
pub(crate) use recipe::{KnownShape, Recipe, Source};
pub(crate) use resting::RestsOn;
pub use scratch::ClothScratch;
pub(crate) use search::BroadPhaseBounds;
pub use search::ClothSearch;
pub(crate) use shared::{Shared, Stiffnesses};
pub(crate) use shared_parts::SharedParts;
pub use stats::ClothStats;
pub(crate) use wind_field::WindField;
