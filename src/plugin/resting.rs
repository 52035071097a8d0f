//! What a cloth sleeps on.

use bevy::{
    ecs::entity::{Entity, EntityMapper, MapEntities},
    math::{Isometry3d, Vec3},
};

use crate::contact::{BodyMass, ColliderShape, MovingCollider};

/// A collider that a cloth touched as it fell asleep, and its way then, in the cloth's frame.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RestsOn {
    pub entity: Entity,
    /// `None` in a snapshot that was written and read: shapes are the game's.
    #[cfg_attr(feature = "serialize", serde(skip))]
    shape: Option<ColliderShape>,
    from: Isometry3d,
    to: Vec3,
    turn: Vec3,
    body: Option<BodyMass>,
}

impl RestsOn {
    pub fn new(entity: Entity, collider: &MovingCollider) -> Self {
        let MovingCollider {
            shape,
            from,
            to,
            turn,
            body,
        } = collider.clone();
        Self {
            entity,
            shape: Some(shape),
            from,
            to,
            turn,
            body,
        }
    }

    /// Whether the collider is what it was, and where it was.
    pub fn is(&self, collider: &MovingCollider) -> bool {
        let is_there = (self.from, self.to, self.turn, self.body)
            == (collider.from, collider.to, collider.turn, collider.body);
        is_there
            && self
                .shape
                .as_ref()
                .is_none_or(|shape| *shape == collider.shape)
    }
}

impl MapEntities for RestsOn {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.entity = mapper.get_mapped(self.entity);
    }
}
