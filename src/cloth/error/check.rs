//! Checks of values, and which errors are alike.

use std::mem::discriminant;

use bevy::ecs::entity::{EntityMapper, MapEntities};

use super::ClothError;

impl MapEntities for ClothError {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        match self {
            Self::NoTarget { target: entity, .. }
            | Self::NoTransform { entity, .. }
            | Self::NoSuchCloth { cloth: entity }
            | Self::Joint { entity, .. } => {
                *entity = mapper.get_mapped(*entity);
            }
            _ => {}
        }
    }
}

impl ClothError {
    /// Whether `other` is at fault in the same place, whatever the value.
    pub(crate) fn is_same_fault(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Quantity { quantity: a, .. }, Self::Quantity { quantity: b, .. }) => a == b,
            (Self::NoTarget { .. }, Self::NoTarget { .. }) => self == other,
            _ => discriminant(self) == discriminant(other),
        }
    }

    /// `value` if it holds to `test`, else the error that names it.
    pub(crate) fn check(
        value: f32,
        test: fn(f32) -> bool,
        quantity: &'static str,
        expected: &'static str,
    ) -> Result<f32, Self> {
        if test(value) {
            Ok(value)
        } else {
            Err(Self::Quantity {
                quantity,
                expected,
                value,
            })
        }
    }
}
