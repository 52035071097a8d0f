//! Transforms of the joints of a skinned mesh.

use bevy::{
    asset::LoadState,
    ecs::system::SystemParam,
    math::Affine3A,
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    prelude::{AnyOf, AssetServer, Assets, Entity, GlobalTransform, Handle, Mat4, Query, Res},
};

use crate::{
    cloth::{ClothError, MeshError, SkinError},
    plugin::authoring::ClothSkeleton,
};

/// The skins of all entities.
#[derive(SystemParam)]
pub(crate) struct Skins<'w, 's> {
    skins: Query<'w, 's, AnyOf<(&'static SkinnedMesh, &'static ClothSkeleton)>>,
    bind_poses: Option<Res<'w, Assets<SkinnedMeshInverseBindposes>>>,
    server: Option<Res<'w, AssetServer>>,
}

impl Skins<'_, '_> {
    /// The bind poses and joints of an entity; those that the game inserted last count first.
    fn of(&self, entity: Entity) -> Option<(&Handle<SkinnedMeshInverseBindposes>, &[Entity])> {
        let (skin, skeleton) = self.skins.get(entity).ok()?;
        let of_skin = skin.map(|skin| (&skin.inverse_bindposes, &*skin.joints));
        of_skin.or(skeleton.map(|skeleton| (&skeleton.inverse_bindposes, &*skeleton.joints)))
    }

    /// The first joint of an entity.
    pub fn first(&self, entity: Entity) -> Option<Entity> {
        self.of(entity)?.1.first().copied()
    }

    /// The matrices that take an entity's mesh, as it is bound, to the world: each joint's global transform, as `place`
    /// knows it, times its inverse bind pose. Empty for an entity that is not skinned.
    ///
    /// # Errors
    /// [`SkinError::Joint`] for a joint without a transform, [`MeshError::Loading`] while the bind poses are
    /// being loaded, [`SkinError::MissingJoints`] if there are none, or fewer than joints.
    pub fn read(
        &self,
        entity: Entity,
        place: impl Fn(Entity) -> Option<GlobalTransform>,
        matrices: &mut Vec<Affine3A>,
    ) -> Result<(), ClothError> {
        matrices.clear();
        let Some((bound, joints)) = self.of(entity) else {
            return Ok(());
        };
        let bind_poses = self.bind_poses.as_ref();
        let Some(inverse) = bind_poses.and_then(|all| all.get(bound)) else {
            let server = self.server.as_ref();
            let state = server.and_then(|server| server.get_load_state(bound));
            return Err(match state {
                Some(LoadState::Loading) => ClothError::Mesh(MeshError::Loading),
                _ => ClothError::Skin(SkinError::MissingJoints {
                    needed: joints.len(),
                    joints: 0,
                }),
            });
        };
        if joints.is_empty() || inverse.len() < joints.len() {
            return Err(ClothError::Skin(SkinError::MissingJoints {
                needed: joints.len(),
                joints: inverse.len(),
            }));
        }
        for (joint, (&entity, inverse)) in joints.iter().zip(inverse.iter()).enumerate() {
            let matrix = place(entity).map(|place| place.affine() * Affine3A::from_mat4(*inverse));
            let matrix = matrix.filter(Affine3A::is_finite);
            matrices.push(matrix.ok_or(SkinError::Joint { joint, entity })?);
        }
        Ok(())
    }

    /// Whether the joints are where `known` has them, to the last bit.
    pub fn are_at(
        &self,
        entity: Entity,
        place: impl Fn(Entity) -> Option<GlobalTransform>,
        known: &[Affine3A],
    ) -> bool {
        let Some((bound, joints)) = self.of(entity) else {
            return known.is_empty();
        };
        let bind_poses = self.bind_poses.as_ref();
        let Some(inverse) = bind_poses.and_then(|all| all.get(bound)) else {
            return false;
        };
        let is_at = |((joint, inverse), known): ((&Entity, &Mat4), &Affine3A)| {
            place(*joint)
                .is_some_and(|place| place.affine() * Affine3A::from_mat4(*inverse) == *known)
        };
        joints.len() == known.len()
            && inverse.len() >= known.len()
            && joints.iter().zip(inverse.iter()).zip(known).all(is_at)
    }
}
