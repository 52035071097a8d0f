//! Cloth that follows its skinned pose.

mod follow;
#[cfg(feature = "mesh")]
mod joints;
#[cfg(not(feature = "mesh"))]
mod no_joints;

pub(crate) use follow::{move_with_pose, place_pose, stand_in_pose};
#[cfg(feature = "mesh")]
pub(crate) use joints::Skins;
#[cfg(not(feature = "mesh"))]
pub(crate) use no_joints::Skins;
