//! Reports the faults of a tick.

use bevy::prelude::{Changed, Commands, Entity, Query, Without, error};

use crate::{
    cloth::{ClothError, ClothParticles},
    plugin::{
        naming::{Named, NamedItem, Part},
        state::{ClothFault, ClothState},
    },
};

/// Marks cloths whose particles became invalid in the tick.
pub(crate) fn report_lost(
    cloths: Query<(Entity, &ClothState, &ClothParticles), Without<ClothFault>>,
    mut commands: Commands,
) {
    for (entity, state, particles) in &cloths {
        if !state.is_valid {
            let outcome = particles.validate().map_err(ClothError::from);
            ClothFault::report(&mut commands, entity, None, Part::Cloth, outcome);
        }
    }
}

/// Logs each fault once, when it appears. Equal faults of one tick share a line.
pub(crate) fn log_faults(faults: Query<(Named, &ClothFault), Changed<ClothFault>>) {
    for (index, (name, fault)) in faults.iter().enumerate() {
        let is_like = |(_, other): &(NamedItem, &ClothFault)| fault.is_like(other);
        if faults.iter().take(index).any(|other| is_like(&other)) {
            continue;
        }
        let (error, others) = (&fault.error, faults.iter().skip(index + 1));
        let name = name.describe(fault.part);
        match others.filter(is_like).count() {
            0 => error!("{name} is left out of the cloth simulation: {error}"),
            others => {
                error!("{name} and {others} more are left out of the cloth simulation: {error}");
            }
        }
    }
}
