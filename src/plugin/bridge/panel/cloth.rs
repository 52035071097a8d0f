//! A cloth, as the panel sees it.

use bevy::ecs::{entity::Entity, name::Name, query::QueryData};

use crate::{
    cloth::ClothMaterial,
    contact::NarrowPhase,
    hierarchy::SearchMethod,
    plugin::{
        draw::ShowClothGizmos,
        state::{ClothBuilt, ClothSearch, ClothStats},
    },
    solver::ClothSettings,
};

/// A cloth with everything that the panel shows and sets.
#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct PanelCloth {
    pub entity: Entity,
    name: Option<&'static Name>,
    pub settings: &'static mut ClothSettings,
    pub material: &'static mut ClothMaterial,
    pub search_method: &'static mut SearchMethod,
    pub narrow_phase: &'static mut NarrowPhase,
    pub show: Option<&'static mut ShowClothGizmos>,
    pub built: &'static ClothBuilt,
    pub search: &'static ClothSearch,
    pub stats: &'static ClothStats,
}

/// Number of letters of a cloth's name that fit.
const LONGEST_NAME: usize = 36;

impl PanelClothItem<'_, '_> {
    pub fn name(&self) -> String {
        let name = self
            .name
            .map_or_else(|| format!("cloth {}", self.entity), ToString::to_string);
        // A header is not cut off by itself.
        name.chars().take(LONGEST_NAME).collect()
    }
}
