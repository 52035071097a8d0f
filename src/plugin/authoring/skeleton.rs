//! The skeleton of a cloth that the plugin draws.

use bevy::{
    asset::Handle,
    ecs::{component::Component, entity::Entity, reflect::ReflectComponent},
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    reflect::{Reflect, std_traits::ReflectDefault},
};

/// The skeleton of a cloth that was spawned with a [`SkinnedMesh`]. It stands in place of the `SkinnedMesh` while the
/// plugin draws the cloth, since the renderer would skin the mesh a second time. Removing
/// [`Cloth`](crate::cloth::Cloth) gives the `SkinnedMesh` back. To change the skeleton, insert a new `SkinnedMesh`,
/// which the plugin takes over.
#[derive(Component, Reflect, Debug, Default, Clone)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone)]
pub struct ClothSkeleton {
    /// Inverse bind poses: they take the mesh, as it is bound, to the frame of each joint.
    pub inverse_bindposes: Handle<SkinnedMeshInverseBindposes>,
    /// The joints, in the mesh's order.
    #[entities]
    pub joints: Vec<Entity>,
}

impl ClothSkeleton {
    /// From a mesh that the renderer skins.
    pub(crate) fn of(skin: &SkinnedMesh) -> Self {
        Self {
            inverse_bindposes: skin.inverse_bindposes.clone(),
            joints: skin.joints.clone(),
        }
    }

    /// The component with which the renderer skins the mesh.
    pub(crate) fn to_skin(&self) -> SkinnedMesh {
        SkinnedMesh {
            inverse_bindposes: self.inverse_bindposes.clone(),
            joints: self.joints.clone(),
        }
    }
}
