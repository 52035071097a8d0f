//! Which cloths meet which colliders.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

/// The collision layers of a cloth or a collider, as bit masks: those that it is in, and those that it meets. Two things
/// touch if each is in a layer that the other's `filters` name. Without this component an entity is in all layers and meets all.
///
/// What is in no layer, or meets none, touches nothing else; a cloth with [`ClothSelfCollision`](super::ClothSelfCollision) still
/// touches itself. A change counts from the next tick on; a cloth that sleeps wakes if
/// it may no longer touch what it lies on.
///
/// These are the cloth's own: the groups of a physics engine say nothing about cloth.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, Clone, PartialEq, Hash)]
pub struct ClothLayers {
    /// The layers that it is in, one bit each.
    pub memberships: u32,
    /// The layers that it meets, one bit each.
    pub filters: u32,
}

impl Default for ClothLayers {
    /// In all layers, meets all.
    fn default() -> Self {
        Self::ALL
    }
}

impl ClothLayers {
    /// In all layers, meets all: as without the component.
    pub const ALL: Self = Self::new(u32::MAX, u32::MAX);

    /// Touches nothing but itself.
    pub const NONE: Self = Self::new(0, 0);

    /// In the layers `memberships`, meets the layers `filters`: one bit each.
    pub const fn new(memberships: u32, filters: u32) -> Self {
        Self {
            memberships,
            filters,
        }
    }

    /// Whether the two may touch: each is in a layer that the other's `filters` name.
    pub const fn interacts_with(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_must_agree() {
        let [first, second] = [0b01, 0b10];
        let cloth = ClothLayers::new(first, second);
        for (other, touches) in [
            (ClothLayers::ALL, true),
            (ClothLayers::NONE, false),
            (ClothLayers::new(second, first), true),
            (ClothLayers::new(first, first), false),
            (ClothLayers::new(second, second), false),
            (ClothLayers::new(second, 0), false),
            (ClothLayers::new(0, first), false),
            (ClothLayers::new(first | second, u32::MAX), true),
        ] {
            assert_eq!(cloth.interacts_with(other), touches, "{other:?}");
            assert_eq!(other.interacts_with(cloth), touches, "{other:?}");
        }
    }
}
