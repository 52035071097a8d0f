//! Collision layers of cloths and colliders.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

/// The collision layers of a cloth or a collider, as bit masks of memberships and filters. Two entities collide if each
/// is a member of a layer in the other's `filters`. Without this component, an entity is in all layers and meets all.
///
/// An entity in no layer, or with empty filters, touches nothing else. A cloth with
/// [`ClothSelfCollision`](crate::contact::ClothSelfCollision) still touches itself. Changes take effect in the next tick. A
/// sleeping cloth wakes if it may no longer touch the collider that it lies on.
///
/// These layers are only for cloth: it ignores the collision groups of a physics engine.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq, Hash)]
pub struct ClothLayers {
    /// The layers that the entity is a member of, one bit each.
    pub memberships: u32,
    /// The layers that the entity collides with, one bit each.
    pub filters: u32,
}

impl Default for ClothLayers {
    /// A member of all layers that collides with all layers.
    fn default() -> Self {
        Self::ALL
    }
}

impl ClothLayers {
    /// A member of all layers that collides with all layers: the same as without the component.
    pub const ALL: Self = Self::new(u32::MAX, u32::MAX);

    /// Touches nothing but itself.
    pub const NONE: Self = Self::new(0, 0);

    /// A member of the layers `memberships` that collides with the layers `filters`: one bit each.
    pub const fn new(memberships: u32, filters: u32) -> Self {
        Self {
            memberships,
            filters,
        }
    }

    /// Whether two entities collide: each is a member of a layer in the other's `filters`.
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
