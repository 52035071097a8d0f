//! The mesh that draws a cloth, and its skeleton.

use bevy::{
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    prelude::{
        AssetId, Component, Entity, Handle, Mesh, Reflect, ReflectComponent, ReflectDefault,
    },
};

/// On a cloth whose [`Mesh3d`](bevy::mesh::Mesh3d) follows its particles, with UVs, normals and tangents. It replaces
/// the entity's own mesh, which comes back when [`Cloth`](crate::cloth::Cloth) is removed. The plugin logs it when a grid
/// replaces a `Mesh3d`. A mesh that the game inserts later on a grid is drawn as it is, in place of the cloth.
///
/// A cloth made from a mesh is drawn with a copy of that mesh, seams included. Give the entity a material with
/// `double_sided: true` and `cull_mode: None`, as `fabric` does: cloth is seen from both sides.
///
/// Pinned and attached particles are drawn where the cloth's entity and its targets are drawn. The cloth is
/// interpolated between ticks. Interpolate colliders that move in `FixedUpdate` too, for instance with the crate
/// `bevy_transform_interpolation`; otherwise they poke through the cloth by up to one tick's motion.
///
/// The mesh of a cloth is not written while Bevy's visibility hides it, its own or an ancestor's. The cloth is still
/// simulated, unless its [`ClothLod`](crate::plugin::ClothLod) says otherwise.
///
/// Scenes and clones hold only the assets that it replaced; everything else is made again.
#[derive(Component, Reflect, Debug, Default, Clone)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone)]
pub struct ClothMesh {
    /// The mesh that is drawn. A clone has that of its original, by which its `Mesh3d` is recognised, until it gets its own.
    #[reflect(ignore)]
    pub(crate) handle: Handle<Mesh>,
    /// The asset that the cloth was made from.
    pub(crate) source: Option<Handle<Mesh>>,
    /// The mesh that the entity drew before.
    pub(crate) replaced: Option<Handle<Mesh>>,
}

impl ClothMesh {
    /// The mesh that is drawn.
    pub fn id(&self) -> AssetId<Mesh> {
        self.handle.id()
    }

    /// The asset that the cloth was made from, if any.
    pub fn source(&self) -> Option<&Handle<Mesh>> {
        self.source.as_ref()
    }
}

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
