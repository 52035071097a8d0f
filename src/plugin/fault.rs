//! What happens to bad input.

use bevy::{
    ecs::{
        component::Component, entity::Entity, lifecycle::Remove, observer::On, system::Commands,
    },
    log::error,
};

use crate::cloth::ClothError;

/// On a cloth or collider that is left out of the simulation: why. Taken away as soon as the fault is mended.
#[derive(Component, Debug, Clone, PartialEq)]
pub struct ClothFault(pub ClothError);

impl ClothFault {
    /// Marks or clears `entity` by the outcome of its check. A fault is logged when it comes, not again while
    /// it lasts.
    pub(super) fn report(
        commands: &mut Commands,
        entity: Entity,
        known: Option<&Self>,
        outcome: Result<(), ClothError>,
    ) {
        match outcome {
            Ok(()) if known.is_some() => {
                commands.entity(entity).try_remove::<Self>();
            }
            Err(error) if known.is_none_or(|known| !known.0.is_same_fault(&error)) => {
                error!("{entity} is left out of the cloth simulation: {error}");
                commands.entity(entity).try_insert(Self(error));
            }
            _ => {}
        }
    }

    /// An entity that no longer is a `C` has no fault.
    pub(super) fn forget_on_removal<C: Component>(removed: On<Remove, C>, mut commands: Commands) {
        commands.entity(removed.entity).try_remove::<Self>();
    }
}
