//! Colliders that are made from drawn meshes.

use std::sync::{Mutex, PoisonError};

use bevy::{
    asset::AssetId,
    ecs::{
        entity::Entity,
        resource::Resource,
        system::{Query, Res, SystemParam},
    },
    mesh::{Mesh, Mesh3d},
    platform::collections::HashMap,
};

use super::asset::Sources;
use crate::{
    cloth::ClothError,
    contact::{ClothCollider, MeshCollider},
    plugin::state::Source,
};

/// The colliders that have been made from meshes, shared by all entities with the same mesh.
#[derive(Resource, Debug, Default)]
pub(crate) struct SharedMeshes(Mutex<HashMap<(Source, MeshCollider), ClothCollider>>);

impl SharedMeshes {
    /// The meshes that colliders have been made from, as long as they are used.
    pub fn meshes(&mut self) -> impl Iterator<Item = AssetId<Mesh>> {
        let shared = self.0.get_mut().unwrap_or_else(PoisonError::into_inner);
        shared.keys().map(|(source, _)| source.mesh)
    }

    /// The mesh is no longer used.
    pub fn forget(&mut self, mesh: AssetId<Mesh>) {
        let shared = self.0.get_mut().unwrap_or_else(PoisonError::into_inner);
        shared.retain(|(known, _), _| known.mesh != mesh);
    }
}

/// The assets that colliders are made of.
#[derive(SystemParam)]
pub(crate) struct ColliderMeshes<'w, 's> {
    meshes: Query<'w, 's, &'static Mesh3d>,
    sources: Sources<'w, 's>,
    shared: Res<'w, SharedMeshes>,
}

impl ColliderMeshes<'_, '_> {
    /// The mesh that a collider is made from, once it has been loaded; `None` for one that is made of none. `known` is the one
    /// that it was made from.
    ///
    /// # Errors
    /// As for a cloth's.
    pub fn find(
        &self,
        entity: Entity,
        collider: &ClothCollider,
        known: Option<Source>,
    ) -> Result<Option<Source>, ClothError> {
        let ClothCollider::Mesh(_) = collider else {
            return Ok(None);
        };
        let Ok(mesh) = self.meshes.get(entity) else {
            return Err(ClothError::MeshNotLoaded);
        };
        self.sources.loaded(mesh.0.id(), known).map(Some)
    }

    /// The collider with its triangles, or its points; itself, if it is made of no mesh.
    ///
    /// # Errors
    /// The error of the mesh.
    pub fn resolve(
        &self,
        collider: &ClothCollider,
        source: Option<Source>,
    ) -> Result<ClothCollider, ClothError> {
        let (ClothCollider::Mesh(kind), Some(source)) = (collider, source) else {
            return Ok(collider.clone());
        };
        let mut shared = self.shared.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(made) = shared.get(&(source, *kind)) {
            return Ok(made.clone());
        }
        let mesh = self.sources.triangles(source.mesh)?;
        let made = match kind {
            MeshCollider::Triangles => ClothCollider::trimesh(mesh.positions, mesh.triangles),
            MeshCollider::Hull => ClothCollider::convex_hull(mesh.positions),
        };
        // Colliders of older versions of the mesh are no longer needed.
        shared.retain(|(known, _), _| known.mesh != source.mesh || *known == source);
        shared.insert((source, *kind), made.clone());
        Ok(made)
    }
}
