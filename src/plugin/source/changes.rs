//! Which meshes a game changes that something is made from.

use bevy::{
    asset::{AssetEvent, AssetId},
    ecs::{
        message::MessageReader,
        system::{Query, ResMut},
    },
    mesh::Mesh,
    platform::collections::HashSet,
};

use super::{
    super::{ClothBuilt, colliders::ColliderMotion},
    asset::ChangedMeshes,
    collider::SharedMeshes,
};

/// Takes over which meshes a game has changed: cloths and colliders that are made from them are built again.
pub(crate) fn note_changed_meshes(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut changed: ResMut<ChangedMeshes>,
    mut shared: ResMut<SharedMeshes>,
    cloths: Query<&ClothBuilt>,
    colliders: Query<&ColliderMotion>,
) {
    if events.is_empty() {
        return;
    }
    let source = |built: &ClothBuilt| {
        built
            .shared
            .recipe
            .as_ref()?
            .source
            .map(|source| source.mesh)
    };
    let of_collider = |motion: &ColliderMotion| motion.source().map(|source| source.mesh);
    let of_colliders = colliders.iter().filter_map(of_collider);
    let sources: HashSet<AssetId<Mesh>> = cloths
        .iter()
        .filter_map(source)
        .chain(of_colliders)
        .collect();
    for event in events.read() {
        match event {
            AssetEvent::Modified { id } | AssetEvent::Removed { id } if sources.contains(id) => {
                changed.note(*id);
            }
            AssetEvent::Unused { id } => {
                changed.forget(*id);
                shared.forget(*id);
            }
            _ => {}
        }
    }
}
