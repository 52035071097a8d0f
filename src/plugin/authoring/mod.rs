//! Components and resources that a game writes, each with its validation.
//!
//! In: the game's values. Out: the same values, which later stages read. Beside some of them lies what the plugin writes with
//! them: the push on a body, the mesh that is drawn, the skeleton taken over, and how far a character has moved.

use bevy::app::App;

use super::reflection::register_with_lists;

mod async_build;
mod attachments;
mod body;
mod bones;
mod grab;
mod gravity;
mod inertia;
mod lod;
#[cfg(feature = "mesh")]
mod mesh;
mod order;
mod seam;
mod wind;
mod wind_zone;

pub use async_build::ClothAsyncBuild;
pub(crate) use attachments::Attached;
pub use attachments::{ClothAttachment, ClothAttachments, ClothTarget, ClothTeleport};
pub use body::{ClothBody, ClothPush};
pub(crate) use bones::{BoneColliderOf, BoneColliders};
pub use bones::{ClothBone, ClothBones};
pub use grab::ClothGrab;
pub(crate) use grab::ClothGrip;
pub use gravity::ClothGravity;
pub use inertia::ClothInertia;
pub(crate) use inertia::{Carried, RootMotion};
pub use lod::{ClothLod, ClothLodLevel, GlobalClothLod};
#[cfg(feature = "mesh")]
pub use mesh::{ClothMesh, ClothSkeleton};
pub use order::ClothOrder;
pub(crate) use order::{Ordered, give_order};
pub(crate) use seam::ClothStitches;
pub use seam::{ClothSeam, ClothSeamSide};
pub(crate) use wind::DENSITY;
pub use wind::{ClothAir, ClothWind};
pub(crate) use wind_zone::PlacedZone;
pub use wind_zone::{ClothWindShape, ClothWindZone};

/// Registers them for scenes and inspectors.
pub(crate) fn register_types(app: &mut App) {
    register_with_lists::<ClothAttachments>(app);
    register_with_lists::<ClothBones>(app);
    register_with_lists::<ClothGrab>(app);
    register_with_lists::<ClothSeam>(app);
    register_with_lists::<ClothLod>(app);
    register_with_lists::<GlobalClothLod>(app);
    app.register_type::<BoneColliderOf>()
        .register_type::<ClothBody>()
        .register_type::<ClothPush>()
        .register_type::<ClothTeleport>()
        .register_type::<ClothAsyncBuild>()
        .register_type::<ClothInertia>()
        .register_type::<ClothGravity>()
        .register_type::<ClothWind>()
        .register_type::<ClothWindZone>()
        .register_type::<ClothOrder>()
        .register_type::<ClothAir>();
}
