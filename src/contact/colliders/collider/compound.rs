//! Several shapes as one.

use bevy::math::{Isometry3d, Vec3};
use parry3d::{math::Pose, shape::SharedShape};

use crate::{
    cloth::{ClothError, FARTHEST, MeshError, ShapeError},
    contact::colliders::{
        geometry::{ColliderGeometry, Parts},
        shape::ColliderShape,
        source::check_scale,
    },
};

/// A part: its pose, that of its shape's frame within, and its shape under the scale.
type Part = (Isometry3d, Isometry3d, Result<ColliderShape, ClothError>);

/// The shape of several parts under a scale.
///
/// # Errors
/// The error of a part, or of its pose.
pub(super) fn scaled(
    children: impl ExactSizeIterator<Item = Part>,
    scale: Vec3,
) -> Result<ColliderShape, ClothError> {
    check_scale(scale)?;
    let no_such = |shape: &str| {
        Err(ClothError::Shape(ShapeError::NoSuchShape {
            shape: shape.to_string(),
        }))
    };
    if children.len() == 0 {
        return no_such("an empty compound");
    }
    let is_even = scale.abs_diff_eq(Vec3::splat(scale.x), 1.0e-5 * scale.length());
    let mut parts = Parts::default();
    for (part, (pose, offset, shape)) in children.enumerate() {
        let pose = part_pose(part, pose)?;
        if shape == Err(MeshError::NotLoaded.into()) {
            return no_such("the entity's `Mesh3d` as a part of a compound");
        }
        // Rotating and then stretching along one axis would shear the part.
        if !is_even && !pose.rotation.is_near_identity() {
            return Err(ShapeError::SkewedPart { scale }.into());
        }
        let place = Vec3::from(pose.translation) * scale;
        let pose = Isometry3d::new(place, pose.rotation) * offset;
        let pose = Pose::from_parts(pose.translation.into(), pose.rotation);
        match shape? {
            ColliderShape::Geometry(geometry) => parts.add_parts(pose, geometry.parts()),
            ColliderShape::Deforming(_) => return no_such("a mesh that deforms in a compound"),
            endless if endless.is_endless() => return no_such("a plane in a compound"),
            simple => {
                let mut added = Ok(());
                simple.for_each_solid(|_, solid| {
                    added = parts.add(pose, &SharedShape(solid.clone_dyn().into()));
                });
                added?;
            }
        }
    }
    Ok(ColliderShape::Geometry(ColliderGeometry::of(parts)))
}

/// The pose of a compound's part, with a normalized rotation.
///
/// # Errors
/// [`ShapeError::PartPose`] for an invalid position or rotation.
fn part_pose(part: usize, pose: Isometry3d) -> Result<Isometry3d, ShapeError> {
    let place = Vec3::from(pose.translation);
    let rotation = pose.rotation.normalize();
    // Not by the largest element, which ignores NaN.
    let is_in_reach = place.abs().cmplt(Vec3::splat(FARTHEST)).all();
    if is_in_reach && rotation.is_finite() && rotation.is_normalized() {
        Ok(Isometry3d::new(place, rotation))
    } else {
        Err(ShapeError::PartPose {
            part,
            place,
            rotation: format!("{:?}", pose.rotation),
        })
    }
}
