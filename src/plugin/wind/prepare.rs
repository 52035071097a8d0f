//! The wind at the beginning of a tick.

use bevy::{
    ecs::{
        entity::Entity,
        system::{Commands, Query, Res, ResMut},
    },
    time::Time,
};

use super::{ClothWind, ClothWindZone, field::WindField, zone::PlacedZone};
use crate::plugin::{ClothFault, frame::Places, naming::Part};

/// Moves the world's wind on, looks where the zones are, and notes what is wrong with one.
pub(in crate::plugin) fn prepare_wind(
    wind: Option<Res<ClothWind>>,
    zones: Query<(Entity, &ClothWindZone, Option<&ClothFault>)>,
    places: Places,
    time: Res<Time>,
    mut field: ResMut<WindField>,
    mut commands: Commands,
) {
    field.advance(wind.as_deref(), &time);
    field.zones.clear();
    for (entity, zone, fault) in &zones {
        let placed = PlacedZone::new(entity, zone, &places);
        let outcome = placed.map(|placed| field.zones.push(placed));
        ClothFault::report(&mut commands, entity, fault, Part::WindZone, outcome);
    }
    // Whatever the order of the world's tables.
    field.zones.sort_unstable_by_key(|zone| zone.entity);
}
