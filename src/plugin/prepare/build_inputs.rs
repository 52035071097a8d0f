//! The inputs and the result of building a cloth.

use bevy::{ecs::change_detection::Tick, math::Vec3};

use crate::{
    cloth::{
        Cloth, ClothError, ClothGrain, ClothMaterial, ClothMaterialMap, ClothShape, ClothTears,
        MaterialFactors, PaintError, Pins, QuantityError, Surface,
    },
    plugin::{
        authoring::ClothAttachment,
        state::{BuildRequest, Recipe, Source},
    },
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
    /// The map of its material, and when that was last changed.
    pub map: Option<(&'a ClothMaterialMap, Tick)>,
    /// Its tears, and when they were last changed.
    pub tears: Option<(&'a ClothTears, Tick)>,
    pub pins: &'a Pins,
    pub attachments: &'a [ClothAttachment],
    pub scale: Vec3,
    /// Whether it collides with itself.
    pub has_layers: bool,
    /// Whether it is built in the background.
    pub is_async: bool,
}

impl BuildInputs<'_> {
    /// When the map of its material was last changed.
    pub(super) fn mapped(&self) -> Option<Tick> {
        self.map.map(|(_, changed)| changed)
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

    /// The request to build a recipe in the background.
    pub(super) fn request(&self, recipe: &Recipe) -> BuildRequest {
        BuildRequest {
            recipe: recipe.clone(),
            material: *self.material,
            map: self.map.map(|(map, _)| map.clone()),
            before: None,
        }
    }

    /// Whether it is a grid whose springs differ or stiffen, which has the surface of a mesh. What is torn has it already.
    pub(super) fn is_as_mesh(&self) -> bool {
        let has_own_springs = || {
            let of_map = |(map, _): (&ClothMaterialMap, Tick)| map.has_stiffness(self.material);
            let stiffening = self.material.stiffening;
            stiffening.is_some_and(|of| of.factor != 1.0) || self.map.is_some_and(of_map)
        };
        let is_torn = self
            .tears
            .is_some_and(|(tears, _)| !tears.edges().is_empty());
        matches!(self.cloth.shape, ClothShape::Grid(_)) && !is_torn && has_own_springs()
    }

    /// Checks the material.
    ///
    /// # Errors
    /// Those of [`ClothMaterial::validate`]; [`QuantityError`] for a rope that stiffens.
    pub(super) fn check_material(&self) -> Result<(), ClothError> {
        self.material.validate()?;
        match self.material.stiffening {
            Some(stiffening) if self.cloth.shape.is_rope() => {
                let quantity = "factor by which a rope stiffens";
                QuantityError::check(stiffening.factor, |factor| factor == 1.0, quantity, "1")?;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The factors of its material.
    ///
    /// # Errors
    /// Those of [`ClothMaterialMap::factors`].
    pub(super) fn factors(&self, surface: &Surface) -> Result<MaterialFactors, PaintError> {
        let of = |(map, _): (&ClothMaterialMap, Tick)| map.factors(surface);
        self.map.map_or_else(|| Ok(MaterialFactors::default()), of)
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
