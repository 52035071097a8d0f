//! Floor 3, the ECS, by the stages of a tick: each folder is a stage, or what stages share. [`DrapePlugins`] adds all of
//! them.
//!
//! ```text
//!   authoring   what a game writes            state   what the plugin keeps
//!
//!   FixedUpdate:   prepare → search → step → write_back          PostUpdate:   draw
//!                                 bridge: rapier, egui, picking, snapshots, diagnostics, origins
//! ```
//!
//! A stage imports from those before it. `simulation` adds the systems in their order.

pub(crate) mod authoring;
mod bridge;
mod clock;
mod draw;
mod frame;
mod naming;
mod prepare;
mod reflection;
mod search;
mod sets;
mod simulation;
mod state;
mod step;
mod threads;
mod write_back;

use bevy::{
    app::{PluginGroup, PluginGroupBuilder},
    ecs::{intern::Interned, schedule::ScheduleLabel},
};

pub use authoring::*;
#[cfg(feature = "egui")]
#[doc(hidden)]
pub use bridge::ClothColliderSpeed;
#[cfg(feature = "picking")]
pub use bridge::ClothPickingPlugin;
#[cfg(feature = "bake")]
pub use bridge::{BakeError, ClothBake};
pub use bridge::{
    ClothBlade, ClothDiagnosticsPlugin, ClothHit, ClothRayCast, ClothSnapshot, ClothWorldSnapshot,
    SnapshotError, shift_cloths,
};
#[cfg(feature = "egui")]
pub use bridge::{ClothPanel, ClothPanelPlugin};
#[cfg(feature = "rapier")]
pub use bridge::{ClothPushBack, ClothRapierPlugin, RapierClothCollider};
#[cfg(feature = "pbr")]
pub use draw::fabric;
#[cfg(feature = "gizmos")]
pub use draw::{ClothGizmos, ClothGizmosPlugin, ShowClothGizmos};
#[cfg(feature = "mesh")]
pub use draw::{ClothMeshPlugin, ClothRenderMesh, ClothRenderMeshPlugin};
pub use frame::ClothFrame;
pub use sets::ClothSystems;
use sets::runs_in_schedule;
pub use simulation::ClothPlugin;
pub use state::{
    ClothBuilt, ClothContact, ClothContacts, ClothFault, ClothScratch, ClothSearch, ClothState,
    ClothStats, ClothTouchStarted, ClothTouchStopped,
};
pub use write_back::{ClothLimitExceeded, ClothTorn};

/// Everything that a game needs: the simulation, its diagnostics and, with their features, the mesh, the gizmos and the
/// bridge to rapier. Add it after Bevy's own plugins.
///
/// The simulation runs in [`FixedUpdate`](bevy::app::FixedUpdate); [`new`](Self::new) chooses another schedule. The panel of the feature `egui`
/// is a separate plugin, `ClothPanelPlugin`.
#[derive(Debug, Clone, Copy)]
pub struct DrapePlugins {
    schedule: Interned<dyn ScheduleLabel>,
}

runs_in_schedule! {
    /// Runs the simulation in `schedule`.
    DrapePlugins
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
