//! What a cloth is tested with, and what came of it.

use std::ops::Range;

use bevy::reflect::Reflect;

use super::{MovingCollider, NarrowPhase};
use crate::cloth::Slot;

/// A particle that a collider may touch in the tick; with triangles, the first of a cell's four.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub particle: u32,
    pub slot: Slot,
    /// Its right neighbour's, if there is such a one and one below: if it begins a cell.
    pub beside: Option<Slot>,
    /// The part of the cloth's area that it stands for (m²).
    pub area: f32,
    /// The deepest that it has been found (m); negative if it has only come so near.
    pub depth: f32,
}

/// A particle near a collider, and how near it came.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Index of the particle; where the collider is tested against triangles, of the first of a cell's four.
    pub particle: u32,
    /// How deep it was found inside in the tick at most (m); negative if it was only so near, and −∞ if it was not
    /// looked at, being pinned or far away.
    pub depth: f32,
}

/// A collider that may touch the cloth in this tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Touch {
    /// Which of the caller's colliders.
    pub id: usize,
    /// Its way.
    pub collider: MovingCollider,
    /// What it is tested against: never `Auto`.
    pub narrow_phase: NarrowPhase,
    /// How deep the deepest was found (m), 0 if none was inside.
    pub deepest: f32,
    /// The largest area of the cloth that was inside at the end of a sub-step (m²).
    pub area: f32,
    /// The largest ∫ depth dA over it (m³).
    pub volume: f32,
    pub(super) candidates: Range<usize>,
}

/// What a cloth is tested with in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terms {
    /// Radius of each particle (m).
    pub particle_radius: f32,
    /// Coulomb's μ.
    pub friction: f32,
    /// What colliders are tested against.
    pub narrow_phase: NarrowPhase,
    /// Whether what moves fast is tested all along its way; only comparisons turn this off.
    pub is_swept: bool,
}

impl Default for Terms {
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
