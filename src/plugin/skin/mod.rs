//! Cloth that follows its skinned pose.

mod follow;
#[cfg(feature = "mesh")]
mod joints;
#[cfg(not(feature = "mesh"))]
mod no_joints;
mod pose;
#[cfg(feature = "mesh")]
mod skeleton;

pub(super) use follow::{move_with_pose, place_pose, stand_in_pose};
#[cfg(feature = "mesh")]
pub(super) use joints::Skins;
#[cfg(not(feature = "mesh"))]
pub(super) use no_joints::Skins;
pub(super) use pose::{Pose, SkinLimits};
#[cfg(feature = "mesh")]
pub use skeleton::ClothSkeleton;
