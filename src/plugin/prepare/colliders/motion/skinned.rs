//! The motion of a collider's joints.

use std::sync::Arc;

use bevy::{
    ecs::entity::Entity,
    math::{Affine3A, Isometry3d, Mat3A, Vec3},
};

use super::{BuiltShape, ColliderMotion};
use crate::{
    cloth::{ClothError, FARTHEST},
    contact::{ClothCollider, ColliderShape, DeformingMesh, SkinnedTriangles},
    plugin::{
        frame::{rigid, unusable},
        prepare::source::ColliderMeshes,
    },
};

/// The meshes that a skinned collider has had in its last ticks.
#[derive(Debug)]
pub(super) struct Skinned {
    triangles: Arc<SkinnedTriangles>,
    known: Vec<DeformingMesh>,
    /// The last of them, and the joints that it was made of.
    last: Option<(DeformingMesh, [Vec<Affine3A>; 2])>,
}

/// The frame of a skinned mesh, which moves with its first joint. Takes the joints' transforms from the world to this
/// frame.
///
/// # Errors
/// [`ClothError::Transform`] for a first joint that is not finite.
fn take_to_frame(joints: &mut [Affine3A]) -> Result<Isometry3d, ClothError> {
    let first = joints.first().copied().unwrap_or_default();
    let place = rigid(&first);
    // A mesh that is scaled to nothing has no rotation.
    let place = match place.rotation.is_finite() {
        true => place,
        false => Isometry3d::from_translation(first.translation),
    };
    let is_far = place.translation.abs().max_element() > FARTHEST;
    if is_far || !place.translation.is_finite() {
        return Err(unusable(first));
    }
    let turn = Mat3A::from_quat(place.rotation.inverse());
    for joint in joints {
        // The difference is taken before it is turned: both may be far from the origin.
        *joint = Affine3A {
            matrix3: turn * joint.matrix3,
            translation: turn * (joint.translation - place.translation),
        };
    }
    Ok(place)
}

impl ColliderMotion {
    /// Takes the joints that have been read to their frame, and makes the shape of the tick. Returns the frame's place.
    ///
    /// # Errors
    /// The error of the mesh, or of its joints.
    pub(super) fn follow_joints(
        &mut self,
        collider: &ClothCollider,
        meshes: &ColliderMeshes,
        entity: Entity,
    ) -> Result<Isometry3d, ClothError> {
        let place = take_to_frame(&mut self.joints_now)?;
        let built = self.built.take();
        let known = built.as_ref().and_then(|built| built.source);
        let source = meshes.find(entity, collider, known)?;
        let source = source.ok_or(ClothError::MeshNotLoaded)?;
        let same = built.filter(|built| built.source == Some(source));
        let mut skinned = match same.and_then(|built| built.skinned) {
            Some(skinned) => skinned,
            None => Skinned::new(meshes.skinned(source)?),
        };
        let from = match self.last.is_some() && self.joints.len() == self.joints_now.len() {
            true => &self.joints,
            false => &self.joints_now,
        };
        let mesh = skinned.moving([from, &self.joints_now])?;
        self.built = Some(BuiltShape {
            collider: collider.clone(),
            source: Some(source),
            scale: Vec3::ONE,
            shape: ColliderShape::Deforming(mesh),
            offset: Isometry3d::IDENTITY,
            skinned: Some(skinned),
        });
        Ok(place)
    }
}

impl Skinned {
    fn new(triangles: Arc<SkinnedTriangles>) -> Self {
        Self {
            triangles,
            known: Vec::new(),
            last: None,
        }
    }

    /// The mesh in a tick that begins and ends with these joints, in its frame.
    ///
    /// # Errors
    /// [`ClothError::SkinJoints`] for fewer joints than it needs.
    fn moving(&mut self, joints: [&[Affine3A]; 2]) -> Result<DeformingMesh, ClothError> {
        let (needed, count) = (self.triangles.joints(), joints[1].len());
        if needed > count {
            return Err(ClothError::SkinJoints {
                needed,
                joints: count,
            });
        }
        if let Some((mesh, known)) = &self.last
            && known[0] == joints[0]
            && known[1] == joints[1]
        {
            return Ok(mesh.clone());
        }
        let mut of = self.last.take().map_or_else(Default::default, |(_, of)| of);
        for (of, joints) in of.iter_mut().zip(joints) {
            of.clear();
            of.extend_from_slice(joints);
        }
        let mesh = self.triangles.moving(joints, &mut self.known);
        self.last = Some((mesh.clone(), of));
        Ok(mesh)
    }
}
