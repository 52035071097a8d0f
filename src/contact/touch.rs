//! What a cloth is tested with, and what came of it.

use bevy::{math::Vec3, reflect::Reflect};

use super::{MovingCollider, NarrowPhase, candidates::Ranges};

/// A particle near a collider, and how near it came.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContactPoint {
    /// Index of the particle; where the collider is tested against triangles, of one that stands for them.
    pub particle: u32,
    /// How deep it was found inside in the tick at most (m); negative if it was only so near, and −∞ if it was not
    /// looked at, being pinned or far away.
    pub depth: f32,
}

/// A collider that may touch the cloth in this tick.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Touch {
    /// Which of the caller's colliders.
    pub id: usize,
    /// Its way.
    pub collider: MovingCollider,
    /// What it is tested against: never `Auto`.
    pub narrow_phase: NarrowPhase,
    /// How deep the deepest was found (m), 0 if none was inside.
    pub deepest: f32,
    /// The largest area of the cloth that was inside at the end of a sub-step (m²); against triangles, of each fourth sub-step, and of
    /// the last.
    pub area: f32,
    /// The largest ∫ depth dA over it (m³).
    pub volume: f32,
    /// What the cloth has given to the collider in the tick so far, in the cloth's frame (N·s): the momentum that contact and
    /// friction took from the cloth. What an overlap is let out by is none.
    pub impulse: Vec3,
    /// The same about the collider's origin, wherever that was in each sub-step (N·m·s).
    pub angular_impulse: Vec3,
    pub(super) of: Ranges,
    /// How far it has moved in the tick so far (m).
    pub(super) traveled: f32,
}

/// What a cloth is tested with in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSettings {
    /// Radius of each particle (m).
    pub particle_radius: f32,
    /// Coulomb's μ.
    pub friction: f32,
    /// What colliders are tested against.
    pub narrow_phase: NarrowPhase,
    /// Whether what moves fast is tested all along its way; only comparisons turn this off.
    #[doc(hidden)]
    pub is_swept: bool,
}

impl Default for ContactSettings {
    /// Points without friction.
    fn default() -> Self {
        Self {
            particle_radius: 0.0,
            friction: 0.0,
            narrow_phase: NarrowPhase::Auto,
            is_swept: true,
        }
    }
}
