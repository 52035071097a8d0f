//! Ways to and from the rest of the world: rapier, egui, snapshots, reflection, diagnostics, and floating origins.
//!
//! In: any of the components. Out: colliders, bodies and velocities of rapier, widgets, snapshots, diagnostics. No stage imports
//! from here.

mod diagnostics;
mod origin;
#[cfg(feature = "egui")]
mod panel;
#[cfg(feature = "rapier")]
mod rapier;
#[cfg(feature = "rapier")]
mod rapier_body;
mod reflection;
mod snapshot;

pub use diagnostics::ClothDiagnosticsPlugin;
pub use origin::shift_cloths;
#[cfg(feature = "egui")]
pub use panel::ClothColliderSpeed;
#[cfg(feature = "egui")]
pub use panel::{ClothPanel, ClothPanelPlugin};
#[cfg(feature = "rapier")]
pub use rapier::{ClothRapierPlugin, RapierClothCollider};
#[cfg(feature = "rapier")]
pub use rapier_body::ClothPushBack;
pub(crate) use reflection::register_lists;
pub use snapshot::{ClothSnapshot, ClothWorldSnapshot, SnapshotError};
