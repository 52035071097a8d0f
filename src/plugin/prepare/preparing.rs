//! The data from which a cloth is prepared.

use bevy::ecs::{
    change_detection::{DetectChanges, Ref, Tick},
    entity::Entity,
    query::{QueryData, With, Without},
    system::{Query, Res, SystemParam},
};

use super::{
    attach::Targets,
    roots::Roots,
    source::{Skins, Sources},
};
use crate::{
    cloth::{
        Cloth, ClothGrain, ClothMaterial, ClothMaterialMap, ClothParticles, ClothShape, ClothSkin,
        ClothTearing, ClothTears, Pins, Surface,
    },
    contact::{ClothSelfCollision, NarrowPhase},
    hierarchy::SearchMethod,
    plugin::{
        authoring::{ClothAir, ClothAsyncBuild, ClothAttachments, ClothLod, ClothTeleport},
        frame::ClothFrame,
        state::{
            BroadPhaseBounds, ClothBuilt, ClothContacts, ClothFault, ClothScratch, ClothSearch,
            ClothState, ClothStats, WindField,
        },
    },
    solver::{ClothCreasing, ClothPressure, ClothSettings},
};

/// The pins of a cloth from which the game took its [`Pins`].
pub(super) static NO_PINS: Pins = Pins::none();

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
    pub air: (Option<&'static ClothAir>, Option<&'static ClothPressure>),
    pub creasing: Option<&'static ClothCreasing>,
    pub lod: Option<&'static ClothLod>,
    pub teleport: Option<&'static ClothTeleport>,
}

/// The grain of a mesh from which the game took its [`ClothGrain`], or that never had one.
static BY_TEXTURE: ClothGrain = ClothGrain::by_texture();

impl GameQueryItem<'_, '_> {
    /// When the map of its material was last changed, if it has one.
    pub fn mapped(&self) -> Option<Tick> {
        self.map.as_ref().map(DetectChanges::last_changed)
    }

    /// Its pressure. A closed surface that is torn open has burst.
    pub fn pressure(&self, surface: &Surface) -> Option<&ClothPressure> {
        let (_, pressure) = self.air;
        pressure.filter(|_| surface.is_closed() || !surface.was_closed())
    }

    /// The tears and when they were last changed, if it has any.
    pub fn tears(&self) -> Option<(&ClothTears, Tick)> {
        let tears = self.torn.0.as_ref()?;
        Some((&**tears, tears.last_changed()))
    }

    /// The grain and when it was last changed, if the cloth is a mesh whose material differs along its weft.
    pub fn grain(&self) -> Option<(&ClothGrain, Option<Tick>)> {
        let is_grid = matches!(self.cloth.shape, ClothShape::Grid(_) | ClothShape::Rope(_));
        if is_grid || !self.material?.is_woven() {
            return None;
        }
        let own = self.grain.as_ref();
        Some(own.map_or((&BY_TEXTURE, None), |grain| {
            (&**grain, Some(grain.last_changed()))
        }))
    }
}

/// A cloth that is prepared for a tick.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct PrepareQuery {
    pub entity: Entity,
    pub game: GameQuery,
    pub particles: &'static mut ClothParticles,
    pub built: &'static mut ClothBuilt,
    pub state: &'static mut ClothState,
    pub scratch: &'static mut ClothScratch,
    pub frame: &'static mut ClothFrame,
    pub stats: &'static mut ClothStats,
    pub bounds: &'static mut BroadPhaseBounds,
    pub search: &'static mut ClothSearch,
    pub contacts: &'static mut ClothContacts,
    pub fault: Option<&'static ClothFault>,
}

/// The inputs of a cloth besides its own components.
#[derive(SystemParam)]
pub(crate) struct Surroundings<'w, 's> {
    pub targets: Targets<'w, 's>,
    pub sources: Sources<'w, 's>,
    pub skins: Skins<'w, 's>,
    pub roots: Roots<'w, 's>,
    pub field: Res<'w, WindField>,
    /// Entities that teleport the cloths below them.
    pub teleports: Query<'w, 's, Entity, (With<ClothTeleport>, Without<Cloth>)>,
    /// Cloths that are built in the background.
    pub async_builds: Query<'w, 's, (), With<ClothAsyncBuild>>,
}
