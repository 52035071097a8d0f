//! Without Bevy's meshes nothing is made from an asset.

use std::{marker::PhantomData, sync::Arc};

use bevy::{
    ecs::{entity::Entity, system::SystemParam},
    math::Affine3A,
};

use crate::{
    cloth::{Cloth, ClothError, Skinning, Surface, TriangleMesh},
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
    pub fn mesh(&self, _: &Recipe) -> Result<TriangleMesh, ClothError> {
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
