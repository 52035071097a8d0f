//! Without Bevy's meshes nothing is skinned.

use std::marker::PhantomData;

use bevy::{
    ecs::{entity::Entity, system::SystemParam},
    math::Affine3A,
    transform::components::GlobalTransform,
};

use crate::cloth::ClothError;

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
