//! The mesh of a cloth.

use std::sync::Arc;

use bevy::{
    asset::{AssetId, Handle},
    ecs::{
        change_detection::Tick,
        component::Component,
        entity::{ComponentCloneCtx, Entity, SourceComponent},
        reflect::ReflectComponent,
    },
    math::{Affine3A, Vec3},
    mesh::Mesh,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    super::{ClothFrame, frame::Shift},
    blend::Blend,
    placing::Carriers,
    skin::DrawnPose,
    write::Tangents,
};
use crate::cloth::Surface;

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
#[derive(Component, Reflect, Debug, Default)]
#[reflect(Component, Default, Debug)]
#[component(clone_behavior = Custom(clone_replaced))]
pub struct ClothMesh {
    #[reflect(ignore)]
    pub(super) handle: Handle<Mesh>,
    /// The asset that the cloth was made from.
    pub(super) source: Option<Handle<Mesh>>,
    /// The mesh that the entity drew before.
    pub(super) replaced: Option<Handle<Mesh>>,
    /// The surface that it is a mesh of.
    #[reflect(ignore)]
    pub(super) surface: Arc<Surface>,
    #[reflect(ignore)]
    pub(super) tangents: Tangents,
    /// Positions as the last tick began, in the cloth's frame.
    #[reflect(ignore)]
    pub(super) previous: Vec<Vec3>,
    /// The carriers of its pins, as of the last two ticks.
    #[reflect(ignore)]
    pub(super) carriers: Carriers,
    /// The pose that it follows, if it does.
    #[reflect(ignore)]
    pub(super) pose: DrawnPose,
    /// Where its targets are drawn.
    #[reflect(ignore)]
    pub(super) targets: Vec<Affine3A>,
    /// Whether those were remembered from a cloth that slept.
    #[reflect(ignore)]
    pub(super) rested: bool,
    /// Positions to be drawn, in the entity's frame.
    #[reflect(ignore)]
    pub(super) drawn: Vec<Vec3>,
    #[reflect(ignore)]
    pub(super) normals: Vec<Vec3>,
    /// The picture of a cloth that sleeps or is frozen: when its particles were written, the place of its entity or of
    /// the frozen particles relative to it, and whether it is visible.
    #[reflect(ignore)]
    pub(super) settled: Option<(Tick, Affine3A, bool)>,
    /// The last picture, and how it blends into the current one.
    #[reflect(ignore)]
    pub(super) before: Vec<Vec3>,
    #[reflect(ignore)]
    pub(super) blend: Blend,
    /// Place of the particles relative to the entity that they are frozen to.
    #[reflect(ignore)]
    pub(super) frozen: Option<Affine3A>,
    /// Whether it drives other meshes, in this frame.
    #[reflect(ignore)]
    pub(super) drives: bool,
    /// Changes whenever it is drawn elsewhere.
    #[reflect(ignore)]
    pub(super) version: u32,
}

/// A clone still has the `Mesh3d` of its original, by which it is recognised, and gets a mesh of its own.
fn clone_replaced(original: &SourceComponent, clone: &mut ComponentCloneCtx) {
    if let Some(original) = original.read::<ClothMesh>() {
        clone.write_target_component(ClothMesh {
            handle: original.handle.clone(),
            source: original.source.clone(),
            replaced: original.replaced.clone(),
            ..ClothMesh::default()
        });
    }
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

    /// In this frame the cloth drives another mesh, so its drawn positions are needed even if it is hidden.
    pub(in crate::plugin) fn drive(&mut self) {
        self.drives = true;
    }

    /// Shifts it with the world's origin, from one frame to another; `target` gives the current place of a target.
    pub(in crate::plugin) fn shift(
        &mut self,
        shift: Shift,
        frames: [ClothFrame; 2],
        target: impl Fn(Entity) -> Option<Affine3A>,
    ) {
        self.carriers.shift(shift, frames, target);
        self.pose.shift(shift, frames);
    }

    /// Whether it is drawn as this surface.
    pub(in crate::plugin) fn is_of(&self, surface: &Arc<Surface>) -> bool {
        Arc::ptr_eq(&self.surface, surface)
    }

    /// Drawn positions of the particles, in the entity's frame, and a number that changes whenever they do.
    pub(in crate::plugin) fn drawn(&self) -> (u32, &[Vec3]) {
        (self.version, &self.drawn)
    }
}
