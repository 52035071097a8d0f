//! Why a snapshot can't be taken or restored.

use bevy::ecs::entity::Entity;
use thiserror::Error;

/// Why a snapshot was not taken or restored. Nothing was changed then.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SnapshotError {
    /// There is no such cloth.
    #[error(
        "{entity} is no cloth in this world: spawn it first, or map a snapshot of another world with `MapEntities`"
    )]
    NoCloth {
        /// What is no cloth.
        entity: Entity,
    },
    /// There is no such collider, root or carrier.
    #[error(
        "the snapshot has {entity} with a `{component}`, and this world does not: spawn it first, or map a snapshot of another world with `MapEntities`"
    )]
    Gone {
        /// What has gone.
        entity: Entity,
        /// What it had.
        component: &'static str,
    },
    /// What a file says of a cloth can't be, as its lists are of different lengths.
    #[error("the snapshot of {entity} is damaged: its lists differ in length")]
    Damaged {
        /// The cloth.
        entity: Entity,
    },
    /// The snapshot was written by another version of the crate.
    #[error("the snapshot is of version {found}, and this is version {expected}")]
    Version {
        /// Of the snapshot.
        found: u32,
        /// Of this crate.
        expected: u32,
    },
}
