//! Storage of a tree's bounding volumes.

use bevy::math::Vec3;

use super::refit::RefitLevels;
use crate::hierarchy::{
    probe::ROUNDING,
    rule::BoundRule,
    volume::{BoundingVolume, Volume, with_volumes},
};

/// Growth factor of a rest radius. Finite, so that a leaf's radius, 0 times this, is always 0.
pub(crate) fn growth(stretch: f32) -> f32 {
    ((1.0 + stretch) * ROUNDING).min(f32::MAX)
}

/// The bounding volumes of one type.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bounds<V: Volume> {
    pub rule: BoundRule,
    /// For `RestShape`: growth factor of a rest radius.
    pub growth: f32,
    /// For `Paper`, those of all nodes; for `Refit`, those of stored nodes.
    pub nodes: Vec<V>,
    /// For `Refit` over a grid.
    pub refit_levels: RefitLevels<V>,
}

impl<V: Volume> Default for Bounds<V> {
    fn default() -> Self {
        Self {
            rule: BoundRule::default(),
            growth: 1.0,
            nodes: Vec::new(),
            refit_levels: RefitLevels {
                lanes: Vec::new(),
                nodes: Vec::new(),
                first: Vec::new(),
            },
        }
    }
}

impl<V: Volume> Bounds<V> {
    /// Around a node's middle particle under `RestShape`.
    #[inline(always)]
    pub fn at_rest(&self, middle: Vec3, rest_radius: f32) -> V {
        V::around(middle, rest_radius * self.growth)
    }
}

macro_rules! define_volumes {
    ($($(#[$doc:meta])* $variant:ident($volume:ty), $name:literal, $takes_all_rules:literal;)*) => {
        /// Bounding volumes of one of the types, so that all loops over nodes are compiled for it.
        #[derive(Debug, Clone, PartialEq)]
        pub(crate) enum Volumes {
            $($variant(Bounds<$volume>),)*
        }

        impl Volumes {
            /// An empty set of a type.
            pub fn of(volume: BoundingVolume) -> Self {
                match volume {
                    $(BoundingVolume::$variant => Self::$variant(Bounds::default()),)*
                }
            }

            /// The type.
            pub fn kind(&self) -> BoundingVolume {
                match self {
                    $(Self::$variant(_) => BoundingVolume::$variant,)*
                }
            }
        }

        define_each! { ($) $($variant)* }
    };
}

/// Defines `each!`, which runs the same code for any type. `$d` is a dollar sign, of the inner macro's own variables.
macro_rules! define_each {
    (($d:tt) $($variant:ident)*) => {
        macro_rules! each {
            ($d volumes:expr, $d bounds:ident => $d code:expr) => {{
                use $crate::hierarchy::tree::Volumes;
                match $d volumes {
                    $(Volumes::$variant($d bounds) => $d code,)*
                }
            }};
        }
    };
}
with_volumes!(define_volumes);
pub(crate) use each;

impl Default for Volumes {
    fn default() -> Self {
        Self::of(BoundingVolume::Sphere)
    }
}
