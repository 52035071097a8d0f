//! Without Bevy's meshes nothing is made from an asset, and there are no cameras.

use std::{marker::PhantomData, sync::Arc};

use bevy::{
    ecs::system::SystemParam,
    math::Affine3A,
    prelude::{Entity, GlobalTransform, Vec3},
};

use crate::{
    cloth::{ClothError, MeshError, Skinning, Surface, TriangleMesh},
    contact::{ClothCollider, SkinnedTriangles},
    plugin::{
        frame::Places,
        state::{Recipe, Source},
    },
};

/// No assets, no skins and no cameras.
#[derive(SystemParam)]
pub(crate) struct Nothing<'w, 's> {
    none: PhantomData<(&'w (), &'s ())>,
}

impl Nothing<'_, '_> {
    /// Neither a cloth nor a collider has one.
    pub fn find<C>(
        &self,
        _: Entity,
        _: &C,
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

    /// No camera is near.
    pub fn nearest(&self, _: Vec3) -> Option<f32> {
        None
    }

    /// Nothing hides an entity.
    pub fn is_hidden(&self, _: Entity) -> bool {
        false
    }
}
