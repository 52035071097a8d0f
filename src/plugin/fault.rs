//! Faults: cloths and colliders with bad input are left out, and logged.

use bevy::{
    ecs::{
        component::Component,
        entity::{Entity, MapEntities},
        query::{Changed, Without},
        reflect::{ReflectComponent, ReflectMapEntities},
        system::{Commands, Query},
    },
    log::error,
    reflect::Reflect,
};

use super::{
    ClothState,
    naming::{Named, NamedItem, Part},
};
use crate::cloth::{ClothError, ClothParticles};

/// On a cloth or collider that is left out of the simulation, with the reason. The plugin removes it as soon as the
/// fault is corrected.
#[derive(Component, Reflect, MapEntities, Debug, Clone, PartialEq)]
#[reflect(Component, MapEntities, Debug, Clone, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct ClothFault {
    /// The reason.
    #[entities]
    pub error: ClothError,
    part: Part,
}

impl ClothFault {
    /// Marks or clears `entity` by the outcome of the check of one part of it.
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
                commands.entity(entity).try_insert(Self { error, part });
            }
            _ => {}
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        self.part == other.part && self.error.is_same_fault(&other.error)
    }
}

/// Marks cloths whose particles became invalid in the tick.
pub(super) fn report_lost(
    cloths: Query<(Entity, &ClothState, &ClothParticles), Without<ClothFault>>,
    mut commands: Commands,
) {
    for (entity, state, particles) in &cloths {
        if !state.is_valid {
            let outcome = particles.validate();
            ClothFault::report(&mut commands, entity, None, Part::Cloth, outcome);
        }
    }
}

/// Logs each fault once, when it appears. Equal faults of one tick share a line.
pub(super) fn log_faults(faults: Query<(Named, &ClothFault), Changed<ClothFault>>) {
    for (index, (name, fault)) in faults.iter().enumerate() {
        let is_like = |(_, other): &(NamedItem, &ClothFault)| fault.is_like(other);
        if faults.iter().take(index).any(|other| is_like(&other)) {
            continue;
        }
        let (error, others) = (&fault.error, faults.iter().skip(index + 1));
        match others.filter(is_like).count() {
            0 => error!(
                "{} is left out of the cloth simulation: {error}",
                name.describe(fault.part)
            ),
            others => error!(
                "{} and {others} more are left out of the cloth simulation: {error}",
                name.describe(fault.part)
            ),
        }
    }
}
