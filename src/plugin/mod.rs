//! Floor 3, the ECS: one plugin per file, and [`DrapePlugins`] over all of them.

mod air;
mod attach;
mod attachments;
mod awaited;
mod body;
mod bone_colliders;
mod bones;
mod broad_phase;
mod build;
mod built;
mod cameras;
mod carry;
mod clock;
#[cfg(feature = "mesh")]
mod cloth_mesh;
mod collider_tree;
mod colliders;
mod components;
mod contacts;
mod cost;
mod diagnostics;
mod drag;
mod envelope;
mod excess;
#[cfg(feature = "pbr")]
mod fabric;
mod fault;
mod faults;
mod follow;
mod frame;
mod freeze;
#[cfg(feature = "gizmos")]
mod gizmos;
mod gravity;
mod inertia;
mod inputs;
mod integrate;
mod islands;
mod levels;
mod lod;
mod lod_state;
#[cfg(feature = "mesh")]
mod mesh;
mod naming;
mod notices;
mod order;
mod origin;
#[cfg(feature = "egui")]
mod panel;
mod parts;
mod prepare;
mod push;
#[cfg(feature = "rapier")]
mod rapier;
#[cfg(feature = "rapier")]
mod rapier_body;
mod reflected;
#[cfg(feature = "mesh")]
mod render_mesh;
mod resample;
mod resting;
mod roots;
mod scratch;
mod search;
mod sets;
mod shared;
mod simulation;
mod skin;
mod snapshot;
mod source;
mod state;
mod stats;
mod threads;
mod tick;
mod together;
mod touch;
mod wind;

use bevy::{
    app::{FixedUpdate, PluginGroup, PluginGroupBuilder},
    ecs::{intern::Interned, schedule::ScheduleLabel},
};

pub use attachments::{ClothAttachment, ClothAttachments, ClothTarget, ClothTeleport};
pub use body::{ClothBody, ClothPush};
pub use bones::{ClothBone, ClothBones};
pub use built::ClothBuilt;
#[cfg(feature = "mesh")]
pub use cloth_mesh::ClothMesh;
pub use components::ClothSearch;
pub use contacts::{ClothContact, ClothContacts, ClothTouchStarted, ClothTouchStopped};
pub use diagnostics::ClothDiagnosticsPlugin;
pub use envelope::ClothLimitExceeded;
#[cfg(feature = "pbr")]
pub use fabric::fabric;
pub use fault::ClothFault;
pub use frame::ClothFrame;
#[cfg(feature = "gizmos")]
pub use gizmos::{ClothGizmos, ClothGizmosPlugin, ShowClothGizmos};
pub use gravity::ClothGravity;
pub use inertia::ClothInertia;
pub use lod::{ClothLod, ClothLodLevel, GlobalClothLod};
#[cfg(feature = "mesh")]
pub use mesh::ClothMeshPlugin;
pub use order::ClothOrder;
pub use origin::shift_cloths;
#[cfg(feature = "egui")]
#[doc(hidden)]
pub use panel::ClothColliderSpeed;
#[cfg(feature = "egui")]
pub use panel::{ClothPanel, ClothPanelPlugin};
#[cfg(feature = "rapier")]
pub use rapier::{ClothRapierPlugin, RapierClothCollider};
#[cfg(feature = "rapier")]
pub use rapier_body::ClothPushBack;
#[cfg(feature = "mesh")]
pub use render_mesh::{ClothRenderMesh, ClothRenderMeshPlugin};
pub use scratch::ClothScratch;
pub use sets::ClothSystems;
pub use simulation::ClothPlugin;
#[cfg(feature = "mesh")]
pub use skin::ClothSkeleton;
pub use snapshot::{ClothSnapshot, ClothWorldSnapshot, SnapshotError};
pub use state::ClothState;
pub use stats::ClothStats;
pub use wind::{ClothAir, ClothWind, ClothWindShape, ClothWindZone};

/// Everything that a game needs: the simulation, its diagnostics and, with their features, the mesh, the gizmos and the
/// bridge to rapier. Add it after Bevy's own plugins.
///
/// The simulation runs in [`FixedUpdate`]; [`new`](Self::new) chooses another schedule. The panel of the feature `egui`
/// is a separate plugin, `ClothPanelPlugin`.
#[derive(Debug, Clone, Copy)]
pub struct DrapePlugins {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Default for DrapePlugins {
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl DrapePlugins {
    /// Runs the simulation in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl PluginGroup for DrapePlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(ClothPlugin::new(self.schedule))
            .add(ClothDiagnosticsPlugin::new(self.schedule));
        #[cfg(feature = "mesh")]
        let group = group
            .add(ClothMeshPlugin::new(self.schedule))
            .add(ClothRenderMeshPlugin);
        #[cfg(feature = "gizmos")]
        let group = group.add(ClothGizmosPlugin);
        #[cfg(feature = "rapier")]
        let group = group.add(ClothRapierPlugin::new(self.schedule));
        group
    }
}
