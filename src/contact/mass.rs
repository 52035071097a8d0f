//! How hard a collider is to move.

use bevy::math::{Mat3, Quat, Vec3};

/// How hard a collider is to move. In the frame in which the cloth moves, as the tick begins.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyMass {
    /// One over its mass (1/kg).
    pub inverse_mass: f32,
    /// Inverse of its inertia about its centre of mass (1/(kg·m²)).
    pub inverse_inertia: Mat3,
    /// From the origin of the collider's shape to the centre of mass (m).
    pub centre: Vec3,
    /// What of a push moves the centre of mass: all, the identity, or all but what goes along the axes that it is locked along.
    pub free: Mat3,
}

impl BodyMass {
    /// The same, seen from another frame.
    pub fn turned(&self, rotation: Quat) -> Self {
        let axes = Mat3::from_quat(rotation);
        Self {
            inverse_mass: self.inverse_mass,
            inverse_inertia: axes * self.inverse_inertia * axes.transpose(),
            centre: rotation * self.centre,
            // The same from all sides.
            free: if self.free == Mat3::IDENTITY {
                Mat3::IDENTITY
            } else {
                axes * self.free * axes.transpose()
            },
        }
    }

    /// One of several equal parts of it, each of which cloths of their own push.
    pub fn part_of(&self, parts: u32) -> Self {
        let parts = parts.max(1) as f32;
        Self {
            inverse_mass: self.inverse_mass * parts,
            inverse_inertia: self.inverse_inertia * parts,
            centre: self.centre,
            free: self.free,
        }
    }
}
