//! The game's settings of a cloth in a tick, checked.

use bevy::math::Vec3;

use super::preparing::GameQueryItem;
use crate::{
    cloth::{ClothError, ClothMaterial, ClothShape, ClothTearing, Surface},
    contact::{ClothSelfCollision, NarrowPhase},
    hierarchy::SearchMethod,
    plugin::state::KnownInputs,
    solver::{ClothCreasing, ClothSettings},
};

/// The game's settings. Removed components count as their defaults.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inputs {
    pub settings: ClothSettings,
    pub material: ClothMaterial,
    pub search: SearchMethod,
    pub narrow_phase: NarrowPhase,
    pub self_collision: Option<ClothSelfCollision>,
    pub creasing: Option<ClothCreasing>,
    pub tearing: Option<ClothTearing>,
    /// In the world (m/s²).
    pub gravity: Vec3,
}

impl Inputs {
    /// The settings of a cloth; `gravity` is that of all cloths (m/s²).
    ///
    /// # Errors
    /// The first value that is out of range. The material is checked when it changes.
    pub fn of(game: &GameQueryItem, gravity: Vec3) -> Result<Self, ClothError> {
        let settings = game.settings.copied().unwrap_or_default();
        let material = game.material.copied().unwrap_or_default();
        settings.validate()?;
        if let Some(tearing) = game.torn.1 {
            tearing.validate(&material)?;
        }
        let search = game.method.copied().unwrap_or_default();
        search.validate()?;
        if let Some(creasing) = game.creasing {
            creasing.validate()?;
        }
        let gravity = settings.gravity.unwrap_or(gravity);
        for value in gravity.to_array() {
            ClothError::check(value, f32::is_finite, "gravity (m/s²)", "finite")?;
        }
        Ok(Self {
            settings,
            material,
            search,
            narrow_phase: match game.cloth.shape {
                // A rope has no triangles.
                ClothShape::Rope(_) => NarrowPhase::Particles,
                _ => game.narrow_phase.copied().unwrap_or_default(),
            },
            self_collision: game.self_collision.copied(),
            creasing: game.creasing.copied(),
            tearing: game.torn.1.copied(),
            gravity,
        })
    }

    /// The distance at which particles lie on colliders (m): a rope's own radius.
    pub fn particle_radius(&self, surface: &Surface) -> f32 {
        surface
            .rope_radius()
            .unwrap_or(self.settings.particle_radius)
    }

    /// Those that wake a cloth at rest when they change. `acceleration` is that of gravity in the cloth's frame (m/s²).
    pub fn known(&self, acceleration: Vec3) -> KnownInputs {
        KnownInputs {
            settings: self.settings,
            search: self.search,
            narrow_phase: self.narrow_phase,
            self_collision: self.self_collision,
            creasing: self.creasing,
            tearing: self.tearing,
            acceleration,
        }
    }
}
