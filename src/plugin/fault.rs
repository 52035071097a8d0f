//! What happens to bad input.

use bevy::{
    ecs::{component::Component, entity::Entity, system::Commands},
    log::error,
};

use crate::cloth::ClothError;

/// On a cloth or collider that is left out of the simulation: why. Taken away as soon as the fault is mended.
#[derive(Component, Debug, Clone, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct ClothFault {
    /// What is wrong.
    pub error: ClothError,
    part: Part,
}

/// What of an entity is at fault: it may be a cloth and a collider at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Cloth,
    Collider,
}

impl ClothFault {
    /// Marks or clears `entity` by the outcome of the check of one part of it. A fault is logged when it comes,
    /// not again while it lasts.
    pub(super) fn report(
        commands: &mut Commands,
        entity: Entity,
        known: Option<&Self>,
        part: Part,
        outcome: Result<(), ClothError>,
    ) {
        match (outcome, known) {
            (Ok(()), Some(known)) if known.part == part => {
                commands.entity(entity).try_remove::<Self>();
            }
            (Err(error), known)
                if known.is_none_or(|k| k.part == part && !k.error.is_same_fault(&error)) =>
            {
                error!("{entity} is left out of the cloth simulation: {error}");
                commands.entity(entity).try_insert(Self { error, part });
            }
            _ => {}
        }
    }
}
