//! The inputs and the result of building a cloth.

use bevy::{ecs::change_detection::Tick, math::Vec3};

use crate::{
    cloth::{
        Cloth, ClothDensity, ClothError, ClothGrain, ClothMaterial, ClothTears, DensityFactors,
        Pins, Surface,
    },
    plugin::{authoring::ClothAttachment, state::Source},
};

/// The game's description of a cloth. Removed components count as their defaults, and as no pins.
pub(crate) struct BuildInputs<'a> {
    pub cloth: &'a Cloth,
    /// When the cloth was last changed.
    pub changed: Tick,
    /// Its mesh, if it is made from one.
    pub source: Option<Source>,
    pub material: &'a ClothMaterial,
    /// The grain of a mesh with a weft, and when it was last changed.
    pub grain: Option<(&'a ClothGrain, Option<Tick>)>,
    /// Its density, and when that was last changed.
    pub density: Option<(&'a ClothDensity, Tick)>,
    /// Its tears, and when they were last changed.
    pub tears: Option<(&'a ClothTears, Tick)>,
    pub pins: &'a Pins,
    pub attachments: &'a [ClothAttachment],
    pub scale: Vec3,
}

impl BuildInputs<'_> {
    /// When its density was last changed.
    pub(super) fn weighed(&self) -> Option<Tick> {
        self.density.map(|(_, changed)| changed)
    }

    /// When its grain was last changed.
    pub(super) fn grained(&self) -> Option<Tick> {
        self.grain.and_then(|(_, changed)| changed)
    }

    /// When its tears were last changed.
    pub(super) fn torn(&self) -> Option<Tick> {
        self.tears.map(|(_, changed)| changed)
    }

    pub(super) fn tears(&self) -> ClothTears {
        self.tears
            .map_or_else(ClothTears::none, |(tears, _)| tears.clone())
    }

    pub(super) fn factors(&self, surface: &Surface) -> Result<DensityFactors, ClothError> {
        self.density.map_or_else(
            || Ok(DensityFactors::default()),
            |(density, _)| density.factors(surface),
        )
    }
}

/// The result of building.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Build {
    /// The particles are those of the last tick.
    Kept,
    /// Of another resolution, or torn, at the places of the last tick.
    Resampled,
    /// New particles.
    New,
}
