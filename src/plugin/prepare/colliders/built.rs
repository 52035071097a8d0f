//! The shapes of colliders.

use bevy::prelude::{Entity, Isometry3d, Vec3};

use super::skinned::SkinnedPose;
use crate::{
    cloth::{Allowed, ClothError, FARTHEST},
    contact::{ClothCollider, ColliderShape},
    plugin::{prepare::source::ColliderMeshes, state::Source},
};

/// A shape and the inputs that it was built from, so that a mesh of many triangles is built only once.
#[derive(Debug)]
pub(super) struct BuiltShape {
    collider: ClothCollider,
    source: Option<Source>,
    scale: Vec3,
    pub shape: ColliderShape,
    /// The shape's frame in that of the entity, or in that of the joints.
    pub offset: Isometry3d,
}

impl BuiltShape {
    /// The shape of a rigid collider under a scale: the `known` one, unless that is of other inputs.
    ///
    /// # Errors
    /// The error of the collider, or of its mesh.
    pub fn rigid(
        known: Option<Self>,
        collider: &ClothCollider,
        meshes: &mut ColliderMeshes,
        entity: Entity,
        scale: Vec3,
    ) -> Result<Self, ClothError> {
        let source = known.as_ref().and_then(|known| known.source);
        let source = meshes.find(entity, collider, source)?;
        if let Some(known) = known.filter(|known| known.is_of(collider, source, scale)) {
            return Ok(known);
        }
        let made = meshes.resolve(collider, source)?;
        let shape = made.scaled(scale)?;
        if !shape.is_endless() {
            check_extent(&shape)?;
        }
        Ok(Self {
            shape,
            offset: made.offset(),
            collider: collider.clone(),
            source,
            scale,
        })
    }

    /// The shape of a skinned collider.
    ///
    /// # Errors
    /// [`QuantityError`] if it is too large.
    pub fn skinned(collider: &ClothCollider, pose: SkinnedPose) -> Result<Self, ClothError> {
        let shape = ColliderShape::Deforming(pose.mesh);
        check_extent(&shape)?;
        Ok(Self {
            shape,
            offset: Isometry3d::IDENTITY,
            collider: collider.clone(),
            source: Some(pose.source),
            scale: Vec3::ONE,
        })
    }

    /// Whether it follows joints.
    pub fn is_skinned(&self) -> bool {
        matches!(self.shape, ColliderShape::Deforming(_))
    }

    fn is_of(&self, collider: &ClothCollider, source: Option<Source>, scale: Vec3) -> bool {
        // A scale that is read out of a rotating transform changes by rounding.
        !self.is_skinned()
            && self.collider == *collider
            && self.source == source
            && self.scale.abs_diff_eq(scale, 1.0e-5 * scale.length())
    }
}

fn check_extent(shape: &ColliderShape) -> Result<(), ClothError> {
    let in_reach = Allowed(|extent| extent <= FARTHEST, "at most 10¹²");
    Ok(in_reach.check("the collider's size (m)", [shape.extent()])?)
}
