//! The colliders that a cloth sleeps on.

use bevy::{
    ecs::entity::MapEntities,
    prelude::{Entity, Isometry3d, Vec3},
};

use crate::contact::{BodyMass, ColliderShape, MovingCollider};

/// Rounding of a path, relative to its distance from the origins of the world and of the cloth.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// Largest displacement of a body in each of the two ticks in which the cloth falls asleep, beyond that of the last (m).
const ASIDE: f32 = 2.0e-3;

/// A path is the same as another from which it differs by less than this fraction: a force of less than a twentieth of the weight
/// does not wake the cloth.
const SAME: f32 = 0.05;

/// A collider that a cloth touched as it fell asleep, and its path then, in the cloth's frame.
#[derive(MapEntities, Debug, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RestsOn {
    #[entities]
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
    /// For how many ticks the cloth has held it, if it is a body: up to two.
    held: u8,
}

impl RestsOn {
    pub fn new(entity: Entity, collider: &MovingCollider) -> Self {
        Self {
            entity,
            shape: Some(collider.shape.clone()),
            from: collider.from,
            to: collider.to,
            turn: collider.turn,
            body: collider.body,
            slack: 0.0,
            held: 0,
        }
    }

    /// Adds the rounding of a place far from the world's origin (m).
    pub fn add_slack(&mut self, rounding: f32) {
        self.slack = self.slack.max(rounding);
    }

    /// Whether it is a body.
    pub fn is_body(&self) -> bool {
        self.body.is_some()
    }

    /// Whether the collider rests as it did then, so far from the world's origin (m).
    pub fn still_rests(&mut self, collider: &MovingCollider, far: f32) -> bool {
        if let Some(body) = self.body {
            return self.is_held(body, collider, far);
        }
        let is_alike = (self.from.rotation, self.turn) == (collider.from.rotation, collider.turn)
            && collider.body.is_none()
            && collider.shape.deformation() == 0.0;
        let is_near = |was: Vec3, now: Vec3| (now - was).abs().max_element() <= self.slack;
        let from = [self.from.translation, collider.from.translation].map(Vec3::from);
        is_alike
            && is_near(from[0], from[1])
            && is_near(self.to, collider.to)
            && self.has_shape_of(collider)
    }

    fn has_shape_of(&self, collider: &MovingCollider) -> bool {
        let shape = self.shape.as_ref();
        shape.is_none_or(|shape| *shape == collider.shape)
    }

    /// Whether a body is where it was, and moves from there as before: by gravity alone, or not at all. In the tick in which the cloth
    /// falls asleep, the body still has a velocity of its own. That is gone a tick later.
    fn is_held(&mut self, body: BodyMass, collider: &MovingCollider, far: f32) -> bool {
        let is_settled = |now: BodyMass| now.is_settled && now.inverse_mass == body.inverse_mass;
        if !self.has_shape_of(collider) || !collider.body.is_some_and(is_settled) {
            return false;
        }
        let extent = collider.shape.extent();
        let length = |path: Vec3, turn: Vec3| path.length() + turn.length() * extent;
        let [start, begin] = [self.from, collider.from].map(|from| Vec3::from(from.translation));
        let (known, path) = (self.to - start, collider.to - begin);
        let rounding = self.slack + ROUNDING * (far + begin.length() + extent);
        let off = length(path - known, collider.turn - self.turn);
        let turned = self.from.rotation.inverse() * collider.from.rotation;
        let moved = length(begin - start, 2.0 * turned.xyz());
        let rests = if self.held < 2 {
            moved <= ASIDE && off <= ASIDE + length(known, self.turn)
        } else {
            let is_still = length(path, collider.turn) <= rounding;
            let is_as_before = off <= SAME * length(known, self.turn) + rounding;
            moved <= rounding && (is_still || is_as_before)
        };
        if rests && self.held < 2 {
            self.held += 1;
            (self.from, self.to, self.turn) = (collider.from, collider.to, collider.turn);
        }
        rests
    }
}
