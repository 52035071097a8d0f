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

/// On a cloth whose [`Mesh3d`](bevy::mesh::Mesh3d) follows its particles, with UVs, normals and tangents; it replaces one that the entity
/// had, which comes back when [`Cloth`](crate::cloth::Cloth) is removed. The plugin logs it when a grid takes the place of a `Mesh3d`. One
/// that the game inserts later on a grid is drawn as it is, in place of the cloth.
///
/// A cloth that is made from a mesh is drawn with a copy of that, seams and all. Give the entity a material with `double_sided: true` and
/// `cull_mode: None`, as `fabric` does: cloth is seen from both sides.
///
/// Pinned and attached particles are drawn where the cloth's entity and their targets are drawn. Interpolate what moves in
/// `FixedUpdate` and touches cloth, as the cloth is, for instance by the crate `bevy_transform_interpolation`.
///
/// The mesh of a cloth that Bevy's visibility hides, its own or an ancestor's, is not written; the cloth moves on all the same, unless its
/// [`ClothLod`](crate::plugin::ClothLod) says otherwise.
///
/// In scenes and clones it is no more than which assets it replaced: all else is made again.
#[derive(Component, Reflect, Debug, Default)]
#[reflect(Component, Default, Debug)]
#[component(clone_behavior = Custom(clone_replaced))]
pub struct ClothMesh {
    #[reflect(ignore)]
    pub(super) handle: Handle<Mesh>,
    /// The asset that the cloth was made from.
    pub(super) source: Option<Handle<Mesh>>,
    /// What the entity drew before.
    pub(super) replaced: Option<Handle<Mesh>>,
    /// What it is a mesh of.
    #[reflect(ignore)]
    pub(super) surface: Arc<Surface>,
    #[reflect(ignore)]
    pub(super) tangents: Tangents,
    /// Positions as the last tick began, in the cloth's frame.
    #[reflect(ignore)]
    pub(super) previous: Vec<Vec3>,
    /// What carries its pins, as of the last two ticks.
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
    /// What is drawn of a cloth that sleeps or is frozen: when its particles were written, where its entity is or how the frozen particles
    /// lie to that, and whether it is seen.
    #[reflect(ignore)]
    pub(super) settled: Option<(Tick, Affine3A, bool)>,
    /// What was drawn before, and how it passes to what is drawn now.
    #[reflect(ignore)]
    pub(super) before: Vec<Vec3>,
    #[reflect(ignore)]
    pub(super) blend: Blend,
    /// How the particles lie to the entity that they are frozen to.
    #[reflect(ignore)]
    pub(super) frozen: Option<Affine3A>,
    /// Whether it drives other meshes, in this frame.
    #[reflect(ignore)]
    pub(super) drives: bool,
    /// New whenever it is drawn elsewhere.
    #[reflect(ignore)]
    pub(super) version: u32,
}

/// A clone has the `Mesh3d` of its original as yet, which it is known by, and is given one of its own.
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

    /// The asset that the cloth was made from, if it was.
    pub fn source(&self) -> Option<&Handle<Mesh>> {
        self.source.as_ref()
    }

    /// In this frame the cloth drives another mesh: where it is drawn has to be known, be it hidden.
    pub(in crate::plugin) fn drive(&mut self) {
        self.drives = true;
    }

    /// Has been shifted with the world's origin, from one frame to another; `target` says where one is now.
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

    /// Where the particles are drawn, in the entity's frame, and a number that is new whenever that is elsewhere.
    pub(in crate::plugin) fn drawn(&self) -> (u32, &[Vec3]) {
        (self.version, &self.drawn)
    }
}
