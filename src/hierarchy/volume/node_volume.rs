//! The bounding volume of a node, of any type.

use bevy::{math::Vec3, reflect::Reflect};

use super::{bounding::Volume, with_volumes};

macro_rules! define_node_volume {
    ($($(#[$doc:meta])* $variant:ident($volume:ty), $name:literal, $takes_all_rules:literal;)*) => {
        /// The bounding volume of a node, around its particles including their radius.
        #[derive(Reflect, Debug, Clone, Copy, PartialEq)]
        #[type_path = "bevy_drape"]
        #[reflect(opaque)]
        #[non_exhaustive]
        pub enum NodeVolume {
            $($(#[$doc])* $variant($volume),)*
        }

        $(impl From<$volume> for NodeVolume {
            fn from(volume: $volume) -> Self {
                Self::$variant(volume)
            }
        })*

        impl NodeVolume {
            /// The corners of each of its faces, in order. Spheres and boxes have none.
            pub fn faces(&self) -> Vec<Vec<Vec3>> {
                match self {
                    $(Self::$variant(volume) => Volume::faces(volume),)*
                }
            }

            /// Inflated by `radius` (m): around particles including their radius.
            pub(crate) fn inflated(&self, radius: f32) -> Self {
                match self {
                    $(Self::$variant(volume) => volume.inflated(radius).into(),)*
                }
            }
        }
    };
}
with_volumes!(define_node_volume);
