//! Errors of bounding volumes.

use bevy::reflect::Reflect;
use thiserror::Error;

/// The reason why a bounding volume is not used.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum BoundsError {
    /// A bounding volume does not support the bound rule.
    #[error(
        "{volume} do not support the bound rule `{rule}`: use `BoundRule::Refit`, or spheres or AABBs"
    )]
    Unsupported {
        /// The bounding volumes, in the plural.
        #[reflect(ignore)]
        volume: &'static str,
        /// The rule.
        #[reflect(ignore)]
        rule: &'static str,
    },
}
