//! The data from which a cloth is prepared.

use bevy::{
    ecs::{query::QueryData, system::SystemParam},
    prelude::{Entity, Query, Res, With, Without},
};

use super::{
    named::Targets,
    roots::Roots,
    source::{Skins, Sources},
};
use crate::{
    cloth::{Cloth, ClothParticles},
    plugin::{
        authoring::{ClothAsyncBuild, ClothTeleport},
        frame::ClothFrame,
        state::{
            BroadPhaseBounds, ClothBuilt, ClothContacts, ClothFault, ClothScratch, ClothSearch,
            ClothState, ClothStats, GameQuery, WindField,
        },
    },
};

/// A cloth that is prepared for a tick.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct PrepareQuery {
    pub entity: Entity,
    pub game: GameQuery,
    pub particles: &'static mut ClothParticles,
    pub built: &'static mut ClothBuilt,
    pub state: &'static mut ClothState,
    pub scratch: &'static mut ClothScratch,
    pub frame: &'static mut ClothFrame,
    pub stats: &'static mut ClothStats,
    pub bounds: &'static mut BroadPhaseBounds,
    pub search: &'static mut ClothSearch,
    pub contacts: &'static mut ClothContacts,
    pub fault: Option<&'static ClothFault>,
}

/// The inputs of a cloth besides its own components.
#[derive(SystemParam)]
pub(crate) struct Surroundings<'w, 's> {
    pub targets: Targets<'w, 's>,
    pub sources: Sources<'w, 's>,
    pub skins: Skins<'w, 's>,
    pub roots: Roots<'w, 's>,
    pub field: Res<'w, WindField>,
    /// Entities that teleport the cloths below them.
    pub teleports: Query<'w, 's, Entity, (With<ClothTeleport>, Without<Cloth>)>,
    /// Cloths that are built in the background.
    pub async_builds: Query<'w, 's, (), With<ClothAsyncBuild>>,
}
