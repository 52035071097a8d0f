//! A cloth that may touch itself or others.

use std::sync::Arc;

use bevy::math::{Isometry3d, Vec3};

use super::{settings::ClothSelfCollision, sheet::Sheet};
use crate::cloth::{ClothParticles, Slot};

/// A cloth with what it is searched by, among those that are moved together.
#[derive(Debug)]
pub(crate) struct Participant<'a> {
    /// Its particles.
    pub particles: &'a mut ClothParticles,
    /// What it is searched by.
    pub sheet: &'a Arc<Sheet>,
    /// From its frame to the one that all have in common; `None` where they are the same.
    pub to_common: Option<Isometry3d>,
    /// How it touches.
    pub settings: ClothSelfCollision,
    /// Whether nothing moves it, as of a cloth that sleeps.
    pub is_fixed: bool,
}

impl<'a> Participant<'a> {
    /// One that meets nothing but itself.
    pub fn alone(
        particles: &'a mut ClothParticles,
        sheet: &'a Arc<Sheet>,
        settings: ClothSelfCollision,
    ) -> Self {
        Self {
            particles,
            sheet,
            to_common: None,
            settings,
            is_fixed: false,
        }
    }

    /// A point of its frame in the common one (m).
    #[inline]
    pub(super) fn point(&self, point: Vec3) -> Vec3 {
        match self.to_common {
            None => point,
            Some(frame) => frame * point,
        }
    }

    /// A vector of its frame in the common one.
    #[inline]
    pub(super) fn vector(&self, vector: Vec3) -> Vec3 {
        match self.to_common {
            None => vector,
            Some(frame) => frame.rotation * vector,
        }
    }

    /// A vector of the common frame in its own.
    #[inline]
    pub(super) fn own_vector(&self, vector: Vec3) -> Vec3 {
        match self.to_common {
            None => vector,
            Some(frame) => frame.rotation.inverse() * vector,
        }
    }

    /// Where a particle is, in the common frame (m).
    pub(super) fn place(&self, Slot { block, lane }: Slot) -> Vec3 {
        self.point(self.particles.blocks()[block].position(lane))
    }
}
