//! Changes of meshes that cloths and colliders are made from.

use bevy::{
    asset::{AssetEvent, AssetId},
    ecs::{
        message::MessageReader,
        system::{Local, Query, ResMut},
    },
    mesh::Mesh,
    platform::collections::HashSet,
};

use super::{asset::ChangedMeshes, collider::SharedMeshes};
use crate::plugin::state::ClothBuilt;

/// Notes the meshes that a game has changed: cloths and colliders that are made from them are built again.
pub(crate) fn note_changed_meshes(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut changed: ResMut<ChangedMeshes>,
    mut shared: ResMut<SharedMeshes>,
    cloths: Query<&ClothBuilt>,
    mut sources: Local<HashSet<AssetId<Mesh>>>,
) {
    if events.is_empty() {
        return;
    }
    // Not by way of the colliders: the meshes of cloths that are drawn change in each frame.
    sources.clear();
    sources.extend(cloths.iter().filter_map(|built| Some(built.source()?.mesh)));
    sources.extend(shared.meshes());
    for event in events.read() {
        match event {
            AssetEvent::Modified { id } | AssetEvent::Removed { id } if sources.contains(id) => {
                *changed.0.entry(*id).or_default() += 1;
            }
            AssetEvent::Unused { id } => {
                changed.0.remove(id);
                shared.forget(*id);
            }
            _ => {}
        }
    }
}
