//! Ways to and from the rest of the world: rapier, egui, picking, blades, snapshots, diagnostics, and floating origins.
//!
//! In: any of the components. Out: colliders, bodies and velocities of rapier, widgets, hits of rays, cuts, snapshots, diagnostics. No stage imports
//! from here.

#[cfg(feature = "bake")]
mod bake;
mod blade;
mod diagnostics;
mod origin;
#[cfg(feature = "egui")]
mod panel;
#[cfg(feature = "picking")]
mod picking;
#[cfg(feature = "rapier")]
mod rapier;
mod ray_cast;
mod snapshot;
mod surface_now;

#[cfg(feature = "bake")]
pub use bake::{BakeError, ClothBake};
pub use blade::ClothBlade;
pub use diagnostics::ClothDiagnosticsPlugin;
pub use origin::shift_cloths;
#[cfg(feature = "egui")]
pub use panel::ClothColliderSpeed;
#[cfg(feature = "egui")]
pub use panel::{ClothPanel, ClothPanelPlugin};
#[cfg(feature = "picking")]
pub use picking::ClothPickingPlugin;
#[cfg(feature = "rapier")]
pub use rapier::{ClothPushBack, ClothRapierPlugin, RapierClothCollider};
pub use ray_cast::{ClothHit, ClothRayCast};
pub use snapshot::{ClothSnapshot, ClothWorldSnapshot, SnapshotError};
