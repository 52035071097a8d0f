//! The colliders that a cloth sleeps on.

use bevy::{
    ecs::entity::{Entity, EntityMapper, MapEntities},
    math::{Isometry3d, Vec3},
};

use crate::contact::{BodyMass, ColliderShape, MovingCollider};

/// A collider that a cloth touched as it fell asleep, and its path then, in the cloth's frame.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RestsOn {
    pub entity: Entity,
    /// `None` in a snapshot that was written and read: shapes are the game's.
    #[cfg_attr(feature = "serialize", serde(skip))]
    shape: Option<ColliderShape>,
    from: Isometry3d,
    to: Vec3,
    turn: Vec3,
    body: Option<BodyMass>,
    /// Possible rounding of its place since then (m).
    slack: f32,
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
            slack: 0.0,
        }
    }

    /// Adds the rounding of a place far from the world's origin (m).
    pub fn add_slack(&mut self, rounding: f32) {
        self.slack = self.slack.max(rounding);
    }

    /// Whether the collider and its place are the same as then.
    pub fn is(&self, collider: &MovingCollider) -> bool {
        let is_alike = (self.from.rotation, self.turn, self.body)
            == (collider.from.rotation, collider.turn, collider.body);
        let is_near = |was: Vec3, now: Vec3| (now - was).abs().max_element() <= self.slack;
        let from = [self.from.translation, collider.from.translation].map(Vec3::from);
        is_alike
            && is_near(from[0], from[1])
            && is_near(self.to, collider.to)
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
