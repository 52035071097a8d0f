//! The mass of a dynamic collider.

use bevy::math::{Mat3, Quat, Vec3};

/// The mass and inertia of a dynamic collider, in the frame in which the cloth moves, at the beginning of the tick.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyMass {
    /// Inverse mass (1/kg).
    pub inverse_mass: f32,
    /// Inverse inertia about its centre of mass (1/(kg·m²)).
    pub inverse_inertia: Mat3,
    /// Vector from the origin of the collider's shape to the centre of mass (m).
    pub centre: Vec3,
    /// Projection of a push onto the free translation axes: the identity, unless translation is locked along some.
    pub free: Mat3,
    /// Whether it has stayed in its place for a while, so that cloth that it lies on may sleep.
    pub is_settled: bool,
}

impl BodyMass {
    /// The same mass in a rotated frame.
    pub fn turned(&self, rotation: Quat) -> Self {
        let axes = Mat3::from_quat(rotation);
        Self {
            inverse_inertia: axes * self.inverse_inertia * axes.transpose(),
            centre: rotation * self.centre,
            // Equal in all directions.
            free: if self.free == Mat3::IDENTITY {
                Mat3::IDENTITY
            } else {
                axes * self.free * axes.transpose()
            },
            ..*self
        }
    }

    /// One of several equal shares of it, each for the cloths of one group.
    pub fn part_of(&self, parts: u32) -> Self {
        let parts = parts.max(1) as f32;
        Self {
            inverse_mass: self.inverse_mass * parts,
            inverse_inertia: self.inverse_inertia * parts,
            ..*self
        }
    }
}
