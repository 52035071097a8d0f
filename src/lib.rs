//! Cloth for [Bevy](https://bevyengine.org), with collisions found by a quad-tree of bounding spheres that is
//! searched from the top down.
//!
//! Add [`DrapePlugins`](plugin::DrapePlugins), spawn a [`Cloth`](cloth::Cloth), and put a
//! [`ClothCollider`](contact::ClothCollider) on whatever it shall touch:
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_drape::prelude::*;
//!
//! fn main() {
//!     App::new()
//!         .add_plugins((MinimalPlugins, DrapePlugins::default()))
//!         .add_systems(Startup, |mut commands: Commands| {
//!             commands.spawn(Cloth::new(32, 32, 0.1));
//!             commands.spawn((ClothCollider::ball(0.5), Transform::from_xyz(1.5, -1.5, 0.5)));
//!         })
//!         .run();
//! }
//! ```
//!
//! # Where things are
//! Each module uses only those above it in this list; all but the last are plain functions on plain data, free
//! of systems and apps, to be tested and measured as such.
//!
//! | module | what lives there |
//! |---|---|
//! | [`cloth`] | what a cloth *is*: its surface, from a grid or a mesh, particles, springs and their colours, material, pins |
//! | [`solver`] | how it *moves*: Verlet, distance constraints, sub-steps, tethers, tolerance, rest |
//! | [`hierarchy`] | how it is *searched*: the quad-tree, bound rules, the top-down query |
//! | [`contact`] | what happens on *touch*: shapes, push-out, friction |
//! | [`plugin`] | the ECS: plugins, system sets, components, messages, mesh, gizmos, diagnostics, rapier, panel |
//!
//! How to use it is told in the [`guide`], chapter by chapter.
//!
//! Lengths are metres, masses kilograms, times seconds throughout.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod cloth;
pub mod contact;
pub mod guide;
pub mod hierarchy;
pub mod plugin;
pub mod solver;

/// What most games need, to be imported with `use bevy_drape::prelude::*`.
pub mod prelude {
    pub use crate::cloth::{
        Cloth, ClothBackstop, ClothError, ClothMaterial, ClothPaint, ClothParticles, ClothPlane,
        ClothShape, ClothSkin, Corner, Pin, Pins, Surface,
    };
    pub use crate::contact::{
        ClothCollider, ClothLayers, ClothSelfCollision, ContactPoint, MeshCollider, NarrowPhase,
    };
    pub use crate::hierarchy::{BoundRule, BoundingVolume, SearchMethod, SearchReason};
    #[cfg(feature = "egui")]
    pub use crate::plugin::ClothPanelPlugin;
    #[cfg(feature = "mesh")]
    pub use crate::plugin::ClothRenderMesh;
    #[cfg(feature = "pbr")]
    pub use crate::plugin::fabric;
    pub use crate::plugin::{
        ClothAir, ClothAttachment, ClothAttachments, ClothBody, ClothBone, ClothBones,
        ClothContact, ClothContacts, ClothFault, ClothFrame, ClothGravity, ClothInertia,
        ClothLimitExceeded, ClothLod, ClothLodLevel, ClothPush, ClothSnapshot, ClothStats,
        ClothSystems, ClothTarget, ClothTeleport, ClothTouchStarted, ClothTouchStopped, ClothWind,
        ClothWindShape, ClothWindZone, ClothWorldSnapshot, DrapePlugins, GlobalClothLod,
        SnapshotError, shift_cloths,
    };
    #[cfg(feature = "gizmos")]
    pub use crate::plugin::{ClothGizmos, ShowClothGizmos};
    #[cfg(feature = "rapier")]
    pub use crate::plugin::{ClothPushBack, RapierClothCollider};
    pub use crate::solver::{ClothLimit, ClothPressure, ClothSettings, Substepping, TimeOrder};
}

/// The README's snippets, compiled with the doc tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
