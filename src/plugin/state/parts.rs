//! The components of a cloth that the plugin keeps.

use super::{
    built::ClothBuilt,
    contacts::ClothContacts,
    memory::ClothState,
    scratch::ClothScratch,
    search::{BroadPhaseBounds, ClothSearch},
    stats::ClothStats,
};
use crate::{
    contact::NarrowPhase,
    hierarchy::SearchMethod,
    plugin::{authoring::ClothOrder, frame::ClothFrame},
    solver::ClothSettings,
};

/// Components that the plugin adds to a cloth. They are not required components: those can't be declared any more once
/// a cloth was spawned before the plugin was added.
pub(crate) type ClothParts = (
    ClothOrder,
    ClothSettings,
    SearchMethod,
    NarrowPhase,
    OwnParts,
);

/// Those of them that are the plugin's own: they go when an entity is no cloth any more.
pub(crate) type OwnParts = (
    ClothBuilt,
    ClothFrame,
    ClothSearch,
    ClothContacts,
    ClothStats,
    ClothState,
    ClothScratch,
    BroadPhaseBounds,
);
