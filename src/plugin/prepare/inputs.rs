//! The game's settings of a cloth in a tick, checked.

use bevy::math::Vec3;

use crate::{
    cloth::{ClothError, ClothMaterial},
    contact::{ClothSelfCollision, NarrowPhase},
    hierarchy::SearchMethod,
    solver::ClothSettings,
};

/// The game's settings. Removed components count as their defaults.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inputs {
    pub settings: ClothSettings,
    pub material: ClothMaterial,
    pub search: SearchMethod,
    pub narrow_phase: NarrowPhase,
    pub self_collision: Option<ClothSelfCollision>,
    /// In the world (m/s²).
    pub gravity: Vec3,
}

impl Inputs {
    /// The settings of a cloth; `gravity` is that of all cloths (m/s²).
    ///
    /// # Errors
    /// The first value that is out of range. The material is checked when it changes.
    pub fn of(
        settings: Option<&ClothSettings>,
        material: Option<&ClothMaterial>,
        search: Option<&SearchMethod>,
        narrow_phase: Option<&NarrowPhase>,
        self_collision: Option<&ClothSelfCollision>,
        gravity: Vec3,
    ) -> Result<Self, ClothError> {
        let settings = settings.copied().unwrap_or_default();
        let material = material.copied().unwrap_or_default();
        settings.validate()?;
        let search = search.copied().unwrap_or_default();
        search.validate()?;
        let gravity = settings.gravity.unwrap_or(gravity);
        for value in gravity.to_array() {
            ClothError::check(value, f32::is_finite, "gravity (m/s²)", "finite")?;
        }
        Ok(Self {
            settings,
            material,
            search,
            narrow_phase: narrow_phase.copied().unwrap_or_default(),
            self_collision: self_collision.copied(),
            gravity,
        })
    }
}
