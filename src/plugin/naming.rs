//! How log messages name an entity.

use bevy::{
    ecs::query::QueryData,
    prelude::{Entity, Name, Reflect},
};

/// The part of an entity that has the fault: an entity may be a cloth and a collider at once, or a mesh that a cloth
/// drives.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
pub(crate) enum Part {
    Cloth,
    Collider,
    Grab,
    #[cfg(feature = "mesh")]
    RenderMesh,
    Seam,
    WindZone,
}

/// An entity, by its [`Name`] where it has one.
#[derive(QueryData)]
pub(crate) struct Named {
    pub entity: Entity,
    name: Option<&'static Name>,
}

impl NamedItem<'_, '_> {
    /// `cloth "flag"`, or `cloth 12v0` where it has no name.
    pub fn describe(&self, part: Part) -> String {
        let part = match part {
            Part::Cloth => "cloth",
            Part::Collider => "cloth collider",
            Part::Grab => "cloth grab",
            #[cfg(feature = "mesh")]
            Part::RenderMesh => "cloth render mesh",
            Part::Seam => "cloth seam",
            Part::WindZone => "cloth wind zone",
        };
        format!("{part} {}", quoted(self.entity, self.name))
    }
}

/// `"flag"`, or `12v0` of an entity without a name.
pub(crate) fn quoted(entity: Entity, name: Option<&Name>) -> String {
    match name {
        Some(name) => format!("\"{name}\""),
        None => entity.to_string(),
    }
}
