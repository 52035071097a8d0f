//! The inputs and the result of building a cloth.

use bevy::prelude::{Mut, Vec3};

use super::source::Sources;
use crate::{
    cloth::{
        Allowed, Cloth, ClothError, ClothGrain, ClothMaterial, ClothMaterialMap, ClothParticles,
        ClothShape, ClothTears, MaterialFactors, PaintError, Pins, Surface,
    },
    plugin::{
        authoring::ClothAttachment,
        state::{Changes, ClothBuilt, ClothState, SharedParts, Source},
    },
};

/// The game's description of a cloth. Removed components count as their defaults, and as no pins.
pub(crate) struct BuildInputs<'a> {
    pub cloth: &'a Cloth,
    pub changes: Changes,
    /// Its mesh, if it is made from one.
    pub source: Option<Source>,
    pub material: &'a ClothMaterial,
    /// The grain of a mesh with a weft.
    pub grain: Option<&'a ClothGrain>,
    /// The map of its material.
    pub map: Option<&'a ClothMaterialMap>,
    pub tears: &'a ClothTears,
    pub pins: &'a Pins,
    pub attachments: &'a [ClothAttachment],
    pub scale: Vec3,
    /// Whether it collides with itself.
    pub has_layers: bool,
    /// Whether it is built in the background.
    pub is_async: bool,
}

impl BuildInputs<'_> {
    /// Calls `hold` for each particle that will be attached, and so pinned where it is.
    pub(super) fn for_each_attached(&self, surface: &Surface, mut hold: impl FnMut(usize)) {
        for attachment in self.attachments {
            if attachment.pin.validate(surface).is_ok() {
                attachment.pin.for_each(surface, &mut hold);
            }
        }
    }

    /// Whether it is a grid whose springs differ or stiffen, which has the surface of a mesh. What is torn has it already.
    pub(super) fn is_as_mesh(&self) -> bool {
        let has_own_springs = || {
            let stiffening = self.material.stiffening;
            stiffening.is_some_and(|of| of.factor != 1.0)
                || self.map.is_some_and(|map| map.has_stiffness(self.material))
        };
        let is_torn = !self.tears.edges().is_empty();
        matches!(self.cloth.shape, ClothShape::Grid(_)) && !is_torn && has_own_springs()
    }

    /// Checks the material.
    ///
    /// # Errors
    /// Those of [`ClothMaterial::validate`]; [`QuantityError`](crate::cloth::QuantityError) for a rope that stiffens.
    pub(super) fn check_material(&self) -> Result<(), ClothError> {
        self.material.validate()?;
        let stiffening = self.material.stiffening;
        let of_rope = stiffening.filter(|_| self.cloth.shape.is_rope());
        let factor = of_rope.map(|of| of.factor);
        Ok(
            Allowed(|factor| factor == 1.0, "1")
                .check("factor by which a rope stiffens", factor)?,
        )
    }

    /// The factors of its material.
    ///
    /// # Errors
    /// Those of [`ClothMaterialMap::factors`].
    pub(super) fn factors(&self, surface: &Surface) -> Result<MaterialFactors, PaintError> {
        let factors = self.map.map(|map| map.factors(surface));
        factors.unwrap_or_else(|| Ok(MaterialFactors::default()))
    }
}

/// A cloth that is built, or that follows changes of its inputs.
pub(crate) struct Building<'a, 'w> {
    pub wanted: &'a BuildInputs<'a>,
    pub sources: &'a Sources<'a, 'a>,
    pub parts: &'a mut SharedParts,
    pub particles: &'a mut Mut<'w, ClothParticles>,
    pub built: &'a mut ClothBuilt,
    pub state: &'a mut ClothState,
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
