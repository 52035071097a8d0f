//! How log messages name an entity.

use bevy::{
    ecs::{entity::Entity, name::Name, query::QueryData},
    reflect::Reflect,
};

/// What of an entity is at fault: it may be a cloth and a collider at once.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Cloth,
    Collider,
    WindZone,
}

/// An entity, by its [`Name`] where it has one.
#[derive(QueryData)]
pub(super) struct Named {
    pub entity: Entity,
    name: Option<&'static Name>,
}

impl NamedItem<'_, '_> {
    /// `cloth "flag"`, or `cloth 12v0` where it has no name.
    pub fn describe(&self, part: Part) -> String {
        let part = match part {
            Part::Cloth => "cloth",
            Part::Collider => "cloth collider",
            Part::WindZone => "cloth wind zone",
        };
        match self.name {
            Some(name) => format!("{part} \"{name}\""),
            None => format!("{part} {}", self.entity),
        }
    }
}
