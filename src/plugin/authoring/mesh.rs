//! The mesh that draws a cloth.

use bevy::{
    asset::{AssetId, Handle},
    ecs::{component::Component, reflect::ReflectComponent},
    mesh::Mesh,
    reflect::{Reflect, std_traits::ReflectDefault},
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
