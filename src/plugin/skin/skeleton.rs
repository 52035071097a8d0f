//! The skeleton of a cloth that the plugin draws.

use bevy::{
    asset::Handle,
    ecs::{component::Component, entity::Entity, reflect::ReflectComponent},
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    reflect::{Reflect, std_traits::ReflectDefault},
};

/// On a cloth that was spawned with a [`SkinnedMesh`], in place of it while the plugin draws the cloth: what is drawn is the cloth, and
/// the renderer would skin it a second time. Removing [`Cloth`](crate::cloth::Cloth) gives it back. A game that changes the skeleton inserts
/// a new `SkinnedMesh`, which is taken over.
#[derive(Component, Reflect, Debug, Default, Clone)]
#[reflect(Component, Default, Debug, Clone)]
pub struct ClothSkeleton {
    /// What takes the mesh to each joint, as it is bound.
    pub inverse_bindposes: Handle<SkinnedMeshInverseBindposes>,
    /// The joints, as the mesh numbers them.
    #[entities]
    pub joints: Vec<Entity>,
}

impl ClothSkeleton {
    /// Of a mesh that the renderer skins.
    pub(crate) fn of(skin: &SkinnedMesh) -> Self {
        Self {
            inverse_bindposes: skin.inverse_bindposes.clone(),
            joints: skin.joints.clone(),
        }
    }

    /// To have the renderer skin it.
    pub(crate) fn to_skin(&self) -> SkinnedMesh {
        SkinnedMesh {
            inverse_bindposes: self.inverse_bindposes.clone(),
            joints: self.joints.clone(),
        }
    }
}
