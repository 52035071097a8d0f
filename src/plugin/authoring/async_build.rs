//! Cloths that are built in the background.

use bevy::prelude::{Component, Reflect, ReflectComponent, ReflectDefault};

/// Builds a cloth on Bevy's `AsyncComputeTaskPool` while the game goes on. A mesh of 4,096 vertices takes some 45 ms, which is
/// longer than a frame. Until it is built, the cloth waits like one whose asset is loading: its
/// [`ClothParticles`](crate::cloth::ClothParticles) are empty, and its mesh is drawn as it is. A cloth that moves already stands still
/// while it is built anew, because its `Cloth` has changed. Changes of its material, map, grain and tears are taken over in their tick.
///
/// The tick in which the cloth begins depends on the machine. Do not use this component where apps have to move alike, such as a server and
/// its clients. A cloth that is restored from a snapshot is built at once.
///
/// Cloths of the same shape and material share the data. Only the first of them waits.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothAsyncBuild;
