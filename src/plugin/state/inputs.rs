//! The game's settings of a cloth: the components that are read, and their values in a tick.

use bevy::{
    ecs::query::QueryData,
    prelude::{DetectChanges, Ref, Vec3},
};

use super::{
    built::{Changes, NO_TEARS},
    forces::ForceQuery,
};
use crate::{
    cloth::{
        Allowed, Cloth, ClothError, ClothGrain, ClothMaterial, ClothMaterialMap, ClothShape,
        ClothSkin, ClothTearing, ClothTears, Pins, Surface,
    },
    contact::{ClothSelfCollision, NarrowPhase},
    hierarchy::SearchMethod,
    plugin::authoring::{ClothAttachment, ClothAttachments, ClothLod, ClothTeleport},
    solver::{ClothCreasing, ClothSettings},
};

/// The components of a cloth that the game writes.
#[derive(QueryData)]
pub(crate) struct GameQuery {
    pub cloth: Ref<'static, Cloth>,
    pub material: Option<&'static ClothMaterial>,
    pub grain: Option<Ref<'static, ClothGrain>>,
    pub map: Option<Ref<'static, ClothMaterialMap>>,
    pub torn: (
        Option<Ref<'static, ClothTears>>,
        Option<&'static ClothTearing>,
    ),
    pub pins: Option<&'static Pins>,
    pub attachments: Option<&'static ClothAttachments>,
    pub skin: Option<Ref<'static, ClothSkin>>,
    pub settings: Option<&'static ClothSettings>,
    pub method: Option<&'static SearchMethod>,
    pub narrow_phase: Option<&'static NarrowPhase>,
    pub self_collision: Option<&'static ClothSelfCollision>,
    pub forces: ForceQuery,
    pub creasing: Option<&'static ClothCreasing>,
    pub lod: Option<&'static ClothLod>,
    pub teleport: Option<&'static ClothTeleport>,
}

/// The grain of a mesh from which the game took its [`ClothGrain`], or that never had one.
static BY_TEXTURE: ClothGrain = ClothGrain::by_texture();

/// The pins of a cloth from which the game took its [`Pins`].
static NO_PINS: Pins = Pins::none();

impl GameQueryItem<'_, '_> {
    /// When the components that it is built from were last changed: the grain only if it matters.
    pub fn changes(&self) -> Changes {
        let grain = self.grain.as_ref().filter(|_| self.grain().is_some());
        Changes {
            cloth: self.cloth.last_changed(),
            grain: grain.map(DetectChanges::last_changed),
            map: self.map.as_ref().map(DetectChanges::last_changed),
            tears: self.torn.0.as_ref().map(DetectChanges::last_changed),
        }
    }

    /// The tears; none if it has none.
    pub fn tears(&self) -> &ClothTears {
        self.torn.0.as_deref().unwrap_or(&NO_TEARS)
    }

    /// The pins; none if it has none.
    pub fn pins(&self) -> &Pins {
        self.pins.unwrap_or(&NO_PINS)
    }

    /// The attachments, if it has any.
    pub fn attachments(&self) -> &[ClothAttachment] {
        let attachments = self.attachments.map(ClothAttachments::as_slice);
        attachments.unwrap_or_default()
    }

    /// The grain, if the cloth is a mesh whose material differs along its weft. Where its strength alone differs, only a
    /// [`ClothGrain`] of the game's.
    pub fn grain(&self) -> Option<&ClothGrain> {
        let shape = &self.cloth.shape;
        let is_grid = shape.is_rope() || matches!(shape, ClothShape::Grid(_));
        let own = self.grain.as_deref();
        let is_woven = self.material.is_some_and(ClothMaterial::is_woven);
        let differs = |of: &ClothTearing| of.strength != of.weft_strength;
        let is_stronger = own.is_some() && self.torn.1.is_some_and(differs);
        if is_grid || !(is_woven || is_stronger) {
            return None;
        }
        Some(own.unwrap_or(&BY_TEXTURE))
    }
}

/// The game's settings of a cloth in a tick, checked. Removed components count as their defaults. A cloth at rest wakes when one
/// of these values changes. Its particles, its place, forces and what it is built from are compared elsewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
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
        Allowed::FINITE.check("gravity (m/s²)", gravity.to_array())?;
        Ok(Self {
            settings,
            material,
            search,
            narrow_phase: match game.cloth.shape.is_rope() {
                // It has no triangles.
                true => NarrowPhase::Particles,
                false => game.narrow_phase.copied().unwrap_or_default(),
            },
            self_collision: game.self_collision.copied(),
            creasing: game.creasing.copied(),
            tearing: game.torn.1.copied(),
            gravity,
        })
    }

    /// The distance at which particles lie on colliders (m): a rope's own radius.
    pub fn particle_radius(&self, surface: &Surface) -> f32 {
        let own = surface.rope_radius();
        own.unwrap_or(self.settings.particle_radius)
    }
}
