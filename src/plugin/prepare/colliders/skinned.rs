//! The motion of skinned colliders.

use std::sync::Arc;

use bevy::{
    math::Affine3A,
    prelude::{Entity, Isometry3d, Mat3A},
};

use crate::{
    cloth::{ClothError, FARTHEST, MeshError, SkinError},
    contact::{ClothCollider, DeformingMesh, SkinnedTriangles},
    plugin::{
        frame::{Places, Shift, rigid, unusable},
        prepare::source::ColliderMeshes,
        state::Source,
    },
};

/// The joints of a skinned collider, and the meshes that it has had in its last ticks; empty for a rigid collider.
#[derive(Debug, Default)]
pub(super) struct SkinnedMotion {
    triangles: Option<(Source, Arc<SkinnedTriangles>)>,
    /// Transforms of the joints, from the mesh to the collider's frame: after the last tick in which time passed, and now.
    pub last: Vec<Affine3A>,
    now: Vec<Affine3A>,
    known: Vec<DeformingMesh>,
    /// The last mesh, and the joints that it was made of.
    made: Option<(DeformingMesh, [Vec<Affine3A>; 2])>,
}

/// A skinned collider in a tick.
pub(super) struct SkinnedPose {
    /// Where its frame is now, which moves with the joint that moves most of the mesh.
    pub place: Isometry3d,
    /// Whether it has no path yet, but begins where it is now.
    pub begins: bool,
    pub mesh: DeformingMesh,
    pub source: Source,
}

impl SkinnedMotion {
    /// Reads the joints of a collider. Returns `None` if it has none.
    ///
    /// # Errors
    /// The error of the mesh, or of its joints.
    pub fn follow(
        &mut self,
        collider: &ClothCollider,
        places: &Places,
        meshes: &mut ColliderMeshes,
        entity: Entity,
    ) -> Result<Option<SkinnedPose>, ClothError> {
        meshes.joints(entity, collider, places, &mut self.now)?;
        if self.now.is_empty() {
            self.stop();
            return Ok(None);
        }
        let known = self.triangles.as_ref().map(|(source, _)| *source);
        let source = meshes.find(entity, collider, known)?;
        let source = source.ok_or(MeshError::NotLoaded)?;
        let known = self.triangles.take().filter(|(known, _)| *known == source);
        let (_, triangles) = match known {
            Some(known) => self.triangles.insert(known),
            None => {
                (self.known, self.made) = (Vec::new(), None);
                self.triangles.insert((source, meshes.skinned(source)?))
            }
        };
        let (needed, joints) = (triangles.joints(), self.now.len());
        if needed > joints {
            return Err(SkinError::MissingJoints { needed, joints }.into());
        }
        let place = take_to_frame(&mut self.now, triangles.carrier())?;
        let begins = self.last.len() != joints;
        if begins {
            self.last.clone_from(&self.now);
        }
        let ends = [&self.last, &self.now];
        let is_made = |(_, of): &&(DeformingMesh, [Vec<Affine3A>; 2])| of.each_ref() == ends;
        let mesh = match self.made.as_ref().filter(is_made) {
            Some((mesh, _)) => mesh.clone(),
            None => {
                let made = self.made.take();
                let mut of = made.map_or_else(Default::default, |(_, of)| of);
                for (of, joints) in of.iter_mut().zip(ends) {
                    of.clone_from(joints);
                }
                let mesh = triangles.moving(ends.map(Vec::as_slice), &mut self.known);
                self.made.insert((mesh, of)).0.clone()
            }
        };
        Ok(Some(SkinnedPose {
            place,
            begins,
            mesh,
            source,
        }))
    }

    /// Time has passed: its next path begins where it is now.
    pub fn pass(&mut self) {
        self.last.clone_from(&self.now);
    }

    /// Wherever it is read next, its path begins there.
    pub fn stop(&mut self) {
        self.last.clear();
    }

    /// Takes over where its joints are in the world after a jump of its origin. If they stand still but for rounding, so does the
    /// mesh, to the last bit. Returns the place of its frame.
    pub fn shift(&mut self, shift: Shift, joints: &mut [Affine3A]) -> Option<Isometry3d> {
        let (_, triangles) = self.triangles.as_ref()?;
        if self.last.len() != joints.len() || triangles.joints() > joints.len() {
            return None;
        }
        let place = take_to_frame(joints, triangles.carrier()).ok()?;
        let rounding = shift.rounding(place.translation);
        let is_near = |(now, was): (&Affine3A, &Affine3A)| {
            now.matrix3 == was.matrix3
                && (now.translation - was.translation).abs().max_element() <= rounding
        };
        if joints.iter().zip(&self.last).all(is_near) {
            self.made = self.made.take().filter(|(_, [from, to])| from == to);
            if let Some((_, ends)) = &mut self.made {
                ends.iter_mut().for_each(|end| end.copy_from_slice(joints));
            }
            self.last.copy_from_slice(joints);
        }
        Some(place)
    }
}

/// The frame of a skinned mesh, which moves with one of its joints. Takes the joints' transforms from the world to this
/// frame.
///
/// # Errors
/// [`Unusable`](crate::cloth::TransformError::Unusable) if that joint is too far away.
fn take_to_frame(joints: &mut [Affine3A], carrier: usize) -> Result<Isometry3d, ClothError> {
    let carrier = joints[carrier];
    let place = rigid(&carrier);
    // A mesh that is scaled to nothing has no rotation.
    let place = match place.rotation.is_finite() {
        true => place,
        false => Isometry3d::from_translation(carrier.translation),
    };
    let is_far = place.translation.abs().max_element() > FARTHEST;
    if is_far || !place.translation.is_finite() {
        return Err(unusable(carrier));
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
