//! Without Bevy's meshes nothing is made from an asset.

use std::{marker::PhantomData, sync::Arc};

use bevy::{
    ecs::{entity::Entity, system::SystemParam},
    math::Affine3A,
    transform::components::GlobalTransform,
};

use crate::{
    cloth::{Cloth, ClothError, MeshError, Skinning, Surface, TriangleMesh},
    contact::{ClothCollider, SkinnedTriangles},
    plugin::{
        frame::Places,
        state::{Recipe, Source},
    },
};

/// No assets.
#[derive(SystemParam)]
pub(crate) struct Sources<'w, 's> {
    none: PhantomData<(&'w (), &'s ())>,
}

impl Sources<'_, '_> {
    /// No cloth has one.
    pub fn find(
        &self,
        _: Entity,
        _: &Cloth,
        _: Option<Source>,
    ) -> Result<Option<Source>, ClothError> {
        Ok(None)
    }

    /// There is no mesh to be skinned.
    pub fn skinning(&self, source: Source, _: &Surface) -> Result<Skinning, ClothError> {
        match source {}
    }

    /// No recipe has any.
    pub fn mesh(&self, _: &Recipe) -> Result<TriangleMesh, MeshError> {
        Ok(TriangleMesh::default())
    }
}

/// No assets for colliders either.
#[derive(SystemParam)]
pub(crate) struct ColliderMeshes<'w> {
    none: PhantomData<&'w ()>,
}

impl ColliderMeshes<'_> {
    /// No collider has one.
    pub fn find(
        &self,
        _: Entity,
        _: &ClothCollider,
        _: Option<Source>,
    ) -> Result<Option<Source>, ClothError> {
        Ok(None)
    }

    /// No collider has joints.
    pub fn joints(
        &self,
        _: Entity,
        _: &ClothCollider,
        _: &Places,
        joints: &mut Vec<Affine3A>,
    ) -> Result<(), ClothError> {
        joints.clear();
        Ok(())
    }

    /// No collider has joints.
    pub fn joint(&self, _: Entity, _: &ClothCollider) -> Option<Entity> {
        None
    }

    /// There is no mesh to be skinned.
    pub fn skinned(&self, source: Source) -> Result<Arc<SkinnedTriangles>, ClothError> {
        match source {}
    }

    /// The collider itself.
    pub fn resolve(
        &self,
        collider: &ClothCollider,
        _: Option<Source>,
    ) -> Result<ClothCollider, ClothError> {
        Ok(collider.clone())
    }
}

/// No skins.
#[derive(SystemParam)]
pub(crate) struct Skins<'w, 's> {
    none: PhantomData<(&'w (), &'s ())>,
}

impl Skins<'_, '_> {
    /// No entity has joints.
    pub fn read(
        &self,
        _: Entity,
        _: impl Fn(Entity) -> Option<GlobalTransform>,
        matrices: &mut Vec<Affine3A>,
    ) -> Result<(), ClothError> {
        matrices.clear();
        Ok(())
    }

    /// There are none.
    pub fn are_at(
        &self,
        _: Entity,
        _: impl Fn(Entity) -> Option<GlobalTransform>,
        known: &[Affine3A],
    ) -> bool {
        known.is_empty()
    }
}
