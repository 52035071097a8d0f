//! The components of a cloth that the plugin keeps.

use super::{
    ClothBuilt, ClothContacts, ClothFrame, ClothOrder, ClothScratch, ClothSearch, ClothState,
    ClothStats, components::BroadPhaseBounds,
};
use crate::{contact::NarrowPhase, hierarchy::SearchMethod, solver::ClothSettings};

/// Components that the plugin adds to a cloth. They are not required components: those can't be declared any more once
/// a cloth was spawned before the plugin was added.
pub(super) type ClothParts = (
    ClothOrder,
    ClothSettings,
    SearchMethod,
    NarrowPhase,
    ClothBuilt,
    ClothFrame,
    ClothSearch,
    ClothContacts,
    ClothStats,
    ClothState,
    ClothScratch,
    BroadPhaseBounds,
);
