//! Faults: cloths and colliders with bad input are left out.

use bevy::{
    ecs::{entity::MapEntities, reflect::ReflectMapEntities},
    prelude::{Commands, Component, Entity, Reflect, ReflectComponent},
};

use crate::{
    cloth::{ClothError, MeshError},
    plugin::naming::Part,
};

/// On a cloth, a collider, a hand or a seam that is left out of the simulation, with the reason. The plugin removes it as soon as the
/// fault is corrected.
#[derive(Component, Reflect, MapEntities, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, MapEntities, Debug, Clone, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct ClothFault {
    /// The reason.
    #[entities]
    pub error: ClothError,
    pub(crate) part: Part,
}

impl ClothFault {
    /// Marks or clears `entity` by the outcome of the check of one part of it. A mesh that is being loaded is no fault.
    pub(crate) fn report(
        commands: &mut Commands,
        entity: Entity,
        known: Option<&Self>,
        part: Part,
        outcome: Result<(), ClothError>,
    ) {
        let outcome = match outcome {
            Err(ClothError::Mesh(MeshError::Loading)) => Ok(()),
            outcome => outcome,
        };
        match (outcome, known) {
            (Ok(()), Some(known)) if known.part == part => {
                commands.entity(entity).try_remove::<Self>();
            }
            (Err(error), known)
                if known.is_none_or(|k| k.part == part && !k.error.is_same_fault(&error)) =>
            {
                commands.entity(entity).try_insert(Self { error, part });
            }
            _ => {}
        }
    }

    /// Whether a line of the log may name both.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        self.part == other.part && self.error.is_same_fault(&other.error)
    }
}
