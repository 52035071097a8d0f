//! Colliders that are made from drawn meshes, and changes of meshes.

use std::sync::Arc;

use bevy::{
    ecs::system::SystemParam,
    math::Affine3A,
    platform::collections::{HashMap, HashSet},
    prelude::{
        AssetEvent, AssetId, Entity, Local, Mesh, Mesh3d, MessageReader, Query, ResMut, Resource,
    },
};

use super::{
    asset::{ChangedMeshes, Sources},
    joints::Skins,
};
use crate::{
    cloth::{ClothError, MeshError},
    contact::{ClothCollider, MeshCollider, SkinnedTriangles},
    plugin::{
        frame::Places,
        state::{ClothBuilt, Source},
    },
};

/// The colliders that have been made from meshes, shared by all entities with the same mesh.
#[derive(Resource, Debug, Default)]
pub(crate) struct SharedMeshes {
    rigid: HashMap<(Source, MeshCollider), ClothCollider>,
    skinned: HashMap<Source, Arc<SkinnedTriangles>>,
}

impl SharedMeshes {
    /// The meshes that colliders have been made from, as long as they are used.
    pub fn meshes(&self) -> impl Iterator<Item = AssetId<Mesh>> {
        let rigid = self.rigid.keys().map(|(source, _)| source);
        rigid.chain(self.skinned.keys()).map(|source| source.mesh)
    }

    /// The mesh is no longer used.
    pub fn forget(&mut self, mesh: AssetId<Mesh>) {
        self.rigid.retain(|(known, _), _| known.mesh != mesh);
        self.skinned.retain(|known, _| known.mesh != mesh);
    }
}

/// The assets that colliders are made of.
#[derive(SystemParam)]
pub(crate) struct ColliderMeshes<'w, 's> {
    meshes: Query<'w, 's, &'static Mesh3d>,
    sources: Sources<'w, 's>,
    skins: Skins<'w, 's>,
    shared: ResMut<'w, SharedMeshes>,
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
            return Err(MeshError::NotLoaded.into());
        };
        self.sources.loaded(mesh.0.id(), known).map(Some)
    }

    /// The transforms of the joints that move a collider's triangles, from the mesh to the world; none if it is rigid.
    ///
    /// # Errors
    /// The error of the joints.
    pub fn joints(
        &self,
        entity: Entity,
        collider: &ClothCollider,
        places: &Places,
        joints: &mut Vec<Affine3A>,
    ) -> Result<(), ClothError> {
        joints.clear();
        match collider {
            ClothCollider::Mesh(MeshCollider::Triangles) => {
                let place = |joint| places.of(joint).ok();
                self.skins.read(entity, place, joints)
            }
            _ => Ok(()),
        }
    }

    /// The first joint that moves a collider's triangles.
    pub fn joint(&self, entity: Entity, collider: &ClothCollider) -> Option<Entity> {
        match collider {
            ClothCollider::Mesh(MeshCollider::Triangles) => self.skins.first(entity),
            _ => None,
        }
    }

    /// The triangles of a skinned mesh.
    ///
    /// # Errors
    /// The error of the mesh.
    pub fn skinned(&mut self, source: Source) -> Result<Arc<SkinnedTriangles>, ClothError> {
        let shared = &mut self.shared.skinned;
        if let Some(made) = shared.get(&source) {
            return Ok(made.clone());
        }
        let made = Arc::new(self.sources.skinned(source)?);
        // Those of older versions of the mesh are no longer needed.
        shared.retain(|known, _| known.mesh != source.mesh);
        shared.insert(source, made.clone());
        Ok(made)
    }

    /// The collider with its triangles, or its points; itself, if it is made of no mesh.
    ///
    /// # Errors
    /// The error of the mesh.
    pub fn resolve(
        &mut self,
        collider: &ClothCollider,
        source: Option<Source>,
    ) -> Result<ClothCollider, ClothError> {
        let (ClothCollider::Mesh(kind), Some(source)) = (collider, source) else {
            return Ok(collider.clone());
        };
        let shared = &mut self.shared.rigid;
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

#[cfg(test)]
mod tests {
    use bevy::{asset::AssetPlugin, mesh::MeshPlugin, prelude::*, time::TimeUpdateStrategy};

    use super::*;
    use crate::plugin::ClothPlugin;

    /// Colliders of one mesh share what is made of it, until the mesh is dropped.
    #[test]
    fn what_is_shared_goes_with_its_mesh() {
        let mut app = App::new();
        let plugins = (AssetPlugin::default(), MeshPlugin, ClothPlugin::default());
        app.add_plugins((MinimalPlugins, TransformPlugin, plugins))
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
        app.finish();
        app.cleanup();
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        let mesh = Mesh3d(meshes.add(Cuboid::default()));
        let made = |app: &App| app.world().resource::<SharedMeshes>().rigid.len();
        for collider in [ClothCollider::mesh(), ClothCollider::mesh_hull()] {
            let both = [(); 2].map(|()| (collider.clone(), mesh.clone()));
            app.world_mut().spawn_batch(both);
        }
        (0..3).for_each(|_| app.update());
        assert_eq!(made(&app), 2);
        let mut colliders = app
            .world_mut()
            .query_filtered::<Entity, With<ClothCollider>>();
        let all: Vec<Entity> = colliders.iter(app.world()).collect();
        drop(mesh);
        for collider in all {
            app.world_mut().despawn(collider);
        }
        (0..3).for_each(|_| app.update());
        assert_eq!(made(&app), 0);
    }
}
