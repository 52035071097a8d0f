//! Prepares the air of a tick.

use bevy::prelude::{Commands, Entity, Query, Res, ResMut, Time};

use crate::plugin::{
    authoring::{ClothOrder, ClothWind, ClothWindZone, PlacedZone},
    frame::Places,
    naming::Part,
    state::{ClothFault, WindField},
};

/// Moves the world's wind on, reads the places of the zones, and reports the faults of zones.
pub(crate) fn prepare_wind(
    wind: Option<Res<ClothWind>>,
    zones: Query<(Entity, &ClothWindZone, Option<&ClothFault>)>,
    orders: Query<&ClothOrder>,
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
    // Independent of the order of the world's tables, and of spawning.
    let order = |zone: Entity| (orders.get(zone).copied().unwrap_or_default(), zone);
    field.zones.sort_unstable_by_key(|zone| order(zone.entity));
}
