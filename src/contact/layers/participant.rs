//! Cloths that may touch themselves or others.

use std::sync::Arc;

use bevy::math::{Isometry3d, Vec3};

use super::{settings::ClothSelfCollision, sheet::Sheet};
use crate::cloth::{ClothParticles, ThicknessFactors};

/// A cloth and its search structure, among cloths that are simulated together.
#[derive(Debug)]
pub(crate) struct Participant<'a> {
    /// Its particles.
    pub particles: &'a mut ClothParticles,
    /// Its search structure.
    pub sheet: &'a Arc<Sheet>,
    /// Transform from its frame to the common one; `None` if they are the same.
    pub to_common: Option<Isometry3d>,
    /// Its contact settings.
    pub settings: ClothSelfCollision,
    /// Where it is thinner than the settings say.
    pub thickness: Option<&'a ThicknessFactors>,
    /// Whether nothing moves it, as for a sleeping cloth.
    pub is_fixed: bool,
}

impl Participant<'_> {
    /// Transforms a point to the common frame (m).
    #[inline]
    pub(super) fn point(&self, point: Vec3) -> Vec3 {
        match self.to_common {
            None => point,
            Some(frame) => frame * point,
        }
    }

    /// Transforms a vector to the common frame.
    #[inline]
    pub(super) fn vector(&self, vector: Vec3) -> Vec3 {
        match self.to_common {
            None => vector,
            Some(frame) => frame.rotation * vector,
        }
    }

    /// Transforms a vector of the common frame to its own.
    #[inline]
    pub(super) fn own_vector(&self, vector: Vec3) -> Vec3 {
        match self.to_common {
            None => vector,
            Some(frame) => frame.rotation.inverse() * vector,
        }
    }
}

/// The smallest thickness of some cloths (m).
pub(super) fn thinnest(cloths: &[Participant]) -> f32 {
    let each = cloths.iter().map(|cloth| {
        let least = cloth.thickness.map_or(1.0, |factors| factors.least);
        cloth.settings.thickness * least
    });
    each.fold(f32::INFINITY, f32::min)
}
