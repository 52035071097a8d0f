//! The order in which cloths, colliders and wind zones act where several meet.

use bevy::prelude::{Component, Entity, Name, Query, Reflect, ReflectComponent, ReflectDefault};

use crate::plugin::frame::Places;

/// The order in which cloths, colliders and wind zones act where several meet: lower values first. The order of results
/// to the last bit, so it must be the same in each app that has to move alike, such as a server and its clients.
///
/// The plugin adds it in an entity's first tick: a hash of the [`Name`] and of the place in the world. So the order of
/// spawning changes nothing. Set it yourself, to any number of your own, where entities share both, or where apps spawn
/// them in different places. 0 stands for none yet. Equal values go by the entity's id.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq, Hash)]
#[component(clone_behavior = Ignore)]
pub struct ClothOrder(pub u64);

/// An entity, sorted by its order.
pub(crate) type Ordered = (ClothOrder, Entity);

/// Gives an order to each entity that has none yet.
pub(crate) fn give_order(mut all: Query<(Entity, Option<&Name>, &mut ClothOrder)>, places: Places) {
    for (entity, name, mut known) in &mut all {
        if known.0 != 0 {
            continue;
        }
        let mut order = hash(OFFSET_BASIS, name.map_or(&[][..], |name| name.as_bytes()));
        if let Ok(place) = places.of(entity) {
            for number in place.affine().to_cols_array() {
                // Minus zero is zero.
                order = hash(order, &(number + 0.0).to_bits().to_le_bytes());
            }
        }
        known.0 = order;
    }
}

const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a, the same on every machine (Fowler, Noll and Vo).
fn hash(before: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(before, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
