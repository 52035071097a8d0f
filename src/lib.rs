//! Cloth for [Bevy](https://bevyengine.org). Add [`DrapePlugins`](plugin::DrapePlugins), spawn a
//! [`Cloth`](cloth::Cloth), and put a [`ClothCollider`](contact::ClothCollider) on whatever it touches:
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_drape::prelude::*;
//!
//! fn main() {
//!     App::new().add_plugins((DefaultPlugins, DrapePlugins::default())).add_systems(Startup, setup).run();
//! }
//!
//! fn setup(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
//!     let red = MeshMaterial3d(materials.add(fabric(Color::srgb(0.7, 0.1, 0.15))));
//!     commands.spawn((Cloth::new(32, 32, 0.1), red));
//!     commands.spawn((ClothCollider::ball(0.5), Transform::from_xyz(1.5, -1.5, 0.5)));
//! }
//! ```
//!
//! The [`guide`] goes on from here: a first cloth, wind, characters, contact, tuning. [`prelude`] lists the components. Lengths
//! are metres, masses kilograms, times seconds.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod cloth;
pub mod contact;
pub mod guide;
pub mod hierarchy;
#[cfg(test)]
#[path = "../tests/shared/meshes.rs"]
pub mod meshes;
pub mod plugin;
pub mod solver;

/// `meshes` calls the crate by this name: other tests include that file, too.
#[cfg(test)]
use crate as library;

/// Most games need only this: `use bevy_drape::prelude::*`.
pub mod prelude {
    #[cfg(feature = "mesh")]
    pub use crate::cloth::RopeError;
    pub use crate::cloth::{
        BoundsError, Cloth, ClothBackstop, ClothError, ClothFactor, ClothGrain, ClothMaterial,
        ClothMaterialMap, ClothPaint, ClothParticles, ClothPlane, ClothShape, ClothSkin,
        ClothStiffening, ClothTearing, ClothTears, ClothWeft, Corner, GrainError, GridError,
        MeshError, PaintError, ParticleError, Pin, PinError, Pins, QuantityError, RopePath,
        RopeShape, SelfCollisionError, ShapeError, SkinError, SpringError, Surface, TargetError,
        TearError, TransformError,
    };
    pub use crate::contact::{
        ClothCollider, ClothLayers, ClothSelfCollision, ContactPoint, MeshCollider, NarrowPhase,
    };
    pub use crate::hierarchy::SearchMethod;
    #[cfg(feature = "picking")]
    pub use crate::plugin::ClothPickingPlugin;
    #[cfg(feature = "mesh")]
    pub use crate::plugin::ClothRenderMesh;
    pub use crate::plugin::authoring::*;
    #[cfg(feature = "pbr")]
    pub use crate::plugin::fabric;
    #[cfg(feature = "bake")]
    pub use crate::plugin::{BakeError, ClothBake};
    pub use crate::plugin::{
        ClothBlade, ClothBuilt, ClothContact, ClothContacts, ClothFault, ClothFrame, ClothHit,
        ClothLimitExceeded, ClothRayCast, ClothSnapshot, ClothStats, ClothSystems, ClothTorn,
        ClothTouchStarted, ClothTouchStopped, ClothWorldSnapshot, DrapePlugins, SnapshotError,
        shift_cloths,
    };
    #[cfg(feature = "gizmos")]
    pub use crate::plugin::{ClothGizmos, ShowClothGizmos};
    #[cfg(feature = "egui")]
    pub use crate::plugin::{ClothPanel, ClothPanelPlugin};
    #[cfg(feature = "rapier")]
    pub use crate::plugin::{ClothPushBack, RapierClothCollider};
    pub use crate::solver::{
        ClothCreasing, ClothLimit, ClothPressure, ClothSettings, Substepping, TimeOrder,
    };
}

/// The README's snippets, compiled with the doc tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
