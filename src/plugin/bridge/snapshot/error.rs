//! Why a snapshot can't be taken or restored.

use bevy::ecs::entity::Entity;
use thiserror::Error;

/// Why a snapshot was not taken or restored. Nothing has been changed then.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SnapshotError {
    /// The entity is not a cloth.
    #[error(
        "{entity} is not a cloth of this world: spawn it first, or map a snapshot of another world with `MapEntities`"
    )]
    NoCloth {
        /// The entity.
        entity: Entity,
    },
    /// A collider, root or carrier of the snapshot is gone.
    #[error(
        "the snapshot has {entity} with a `{component}`, and this world does not: spawn it first, or map a snapshot of another world with `MapEntities`"
    )]
    Gone {
        /// The entity that is gone.
        entity: Entity,
        /// The component that it had.
        component: &'static str,
    },
    /// A file holds lists of different lengths for a cloth.
    #[error("the snapshot of {entity} is damaged: its lists have different lengths")]
    Damaged {
        /// The cloth.
        entity: Entity,
    },
    /// The snapshot was written by another version of the crate.
    #[error(
        "the snapshot has version {found}, but this version of bevy_drape reads version {expected}"
    )]
    Version {
        /// Version of the snapshot.
        found: u32,
        /// Version that this crate reads.
        expected: u32,
    },
}
