//! Bounding volumes of a tree's nodes.

mod aabb;
mod bounding;
mod kdop;
mod node_volume;
mod obb;
mod slabs;
mod sphere;
#[cfg(test)]
mod tests;

use bevy::reflect::{Reflect, std_traits::ReflectDefault};

pub(crate) use bounding::Volume;
pub use kdop::KDop;
pub use node_volume::NodeVolume;
pub use obb::Obb;

/// A type of bounding volume.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
pub enum BoundingVolume {
    /// A sphere.
    #[default]
    Sphere,
    /// An axis-aligned box in the cloth's frame.
    Aabb,
    /// An oriented box.
    Obb,
    /// A 14-DOP, between seven pairs of parallel planes: a box with its corners cut off.
    KDop14,
    /// An 18-DOP, between nine pairs: a box with its edges cut off.
    KDop18,
    /// A 26-DOP, between thirteen pairs: a box with its corners and edges cut off.
    KDop26,
}

impl BoundingVolume {
    /// The volumes with their names, for menus.
    pub const ALL: [(&str, Self); 6] = [
        ("spheres", Self::Sphere),
        ("AABBs", Self::Aabb),
        ("OBBs", Self::Obb),
        ("14-DOPs", Self::KDop14),
        ("18-DOPs", Self::KDop18),
        ("26-DOPs", Self::KDop26),
    ];

    /// Its name, in the plural.
    pub fn name(self) -> &'static str {
        let is_it = |(_, each): &&(&str, Self)| *each == self;
        Self::ALL.iter().find(is_it).map_or("", |(name, _)| name)
    }
}
