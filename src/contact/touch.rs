//! What a cloth is tested with, and what came of it.

use std::ops::Range;

use bevy::reflect::Reflect;

use super::{MovingCollider, NarrowPhase};
use crate::cloth::{Layout, Slot, Surface};

/// A particle that a collider may touch in the tick; with triangles, one that stands for some.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub particle: u32,
    pub slot: Slot,
    /// From where to where the corners and the faces that it stands for are among the [`Fans`]; none without triangles.
    pub corners: [u32; 2],
    pub faces: [u32; 2],
    /// The part of the cloth's area that it stands for (m²).
    pub area: f32,
    /// The deepest that it has been found (m); negative if it has only come so near.
    pub depth: f32,
}

/// The faces that candidates stand for.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Fans {
    /// All corners of each candidate's faces, each once.
    corners: Vec<Slot>,
    faces: Vec<[Slot; 3]>,
    /// How many triangles a particle may be a corner of, and be pushed by.
    pub max_faces: f32,
}

impl Fans {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.corners.clear();
        self.faces.clear();
    }

    /// Adds the faces that a particle stands for. Returns from where to where their corners and they are.
    pub fn add(&mut self, surface: &Surface, layout: Layout, particle: u32) -> [[u32; 2]; 2] {
        let (first_corner, first_face) = (self.corners.len(), self.faces.len());
        for face in surface.faces().of(particle) {
            let slots = face.map(|corner| layout.slot_of(corner as usize));
            for slot in slots {
                if !self.corners[first_corner..].contains(&slot) {
                    self.corners.push(slot);
                }
            }
            self.faces.push(slots);
        }
        [
            [first_corner as u32, self.corners.len() as u32],
            [first_face as u32, self.faces.len() as u32],
        ]
    }

    pub fn corners(&self, [first, end]: [u32; 2]) -> &[Slot] {
        &self.corners[first as usize..end as usize]
    }

    pub fn faces(&self, [first, end]: [u32; 2]) -> &[[Slot; 3]] {
        &self.faces[first as usize..end as usize]
    }
}

/// A particle near a collider, and how near it came.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Index of the particle; where the collider is tested against triangles, of one that stands for them.
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
