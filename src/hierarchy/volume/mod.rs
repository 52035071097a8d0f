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

/// Calls a macro with all volumes: the variant's docs and name, its type, its name in menus, and whether it supports every rule.
/// A new volume is a line here, and a file with its [`Volume`].
macro_rules! with_volumes {
    ($then:ident) => {
        $then! {
            #[doc = "A sphere."]
            Sphere(bevy::math::bounding::BoundingSphere), "spheres", true;
            #[doc = "An axis-aligned box in the cloth's frame."]
            Aabb(bevy::math::bounding::Aabb3d), "AABBs", true;
            #[doc = "An oriented box."]
            Obb(crate::hierarchy::volume::Obb), "OBBs", false;
            #[doc = "A 14-DOP, between seven pairs of parallel planes: a box with its corners cut off."]
            KDop14(crate::hierarchy::volume::KDop<7>), "14-DOPs", false;
            #[doc = "An 18-DOP, between nine pairs: a box with its edges cut off."]
            KDop18(crate::hierarchy::volume::KDop<9>), "18-DOPs", false;
            #[doc = "A 26-DOP, between thirteen pairs: a box with its corners and edges cut off."]
            KDop26(crate::hierarchy::volume::KDop<13>), "26-DOPs", false;
        }
    };
}
pub(crate) use with_volumes;

macro_rules! define_bounding_volume {
    ($($(#[$doc:meta])* $variant:ident($volume:ty), $name:literal, $takes_all_rules:literal;)*) => {
        /// A type of bounding volume.
        #[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[type_path = "bevy_drape"]
        #[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
        #[reflect(Default, Debug, Clone, PartialEq, Hash)]
        pub enum BoundingVolume {
            $($(#[$doc])* $variant,)*
        }

        impl BoundingVolume {
            /// The volumes with their names, for menus.
            pub const ALL: [(&str, Self); [$($name),*].len()] = [$(($name, Self::$variant)),*];

            /// Its name, in the plural.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// Whether it supports all rules, not `Refit` alone.
            pub(super) const fn takes_all_rules(self) -> bool {
                match self {
                    $(Self::$variant => $takes_all_rules,)*
                }
            }
        }
    };
}
with_volumes!(define_bounding_volume);

impl Default for BoundingVolume {
    fn default() -> Self {
        Self::Sphere
    }
}
