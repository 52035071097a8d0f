//! Sources of complex shapes.

use std::sync::{Arc, OnceLock};

use bevy::{
    math::{Isometry3d, Vec3},
    reflect::Reflect,
};
use parry3d::{math::Pose, shape::SharedShape};

use super::{
    geometry::{ColliderGeometry, Parts, turn_up},
    shape::ColliderShape,
};
use crate::cloth::{Allowed, ClothError, QuantityError, ShapeError};

/// A shape of many points, before the transform's scale. Clones share it and the geometry built from it: cloning is
/// cheap, and clones are equal.
#[derive(Reflect, Debug, Clone)]
#[type_path = "bevy_drape"]
#[reflect(opaque, Debug, Clone, PartialEq)]
pub struct SharedCollider(Arc<Made>);

#[derive(Debug)]
struct Made {
    source: Source,
    /// The result for the first valid scale.
    built: OnceLock<(Vec3, ColliderShape)>,
}

#[derive(Debug)]
pub(super) enum Source {
    /// Loaded from a file, which cannot store any of these.
    Nothing,
    Hull(Vec<Vec3>),
    Triangles(Vec<Vec3>, Vec<[u32; 3]>),
    HeightField {
        heights: Vec<f32>,
        columns: usize,
        size: Vec3,
    },
    /// In world units, whatever the transform's scale.
    Parry(SharedShape),
}

impl PartialEq for SharedCollider {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Default for SharedCollider {
    /// The value loaded from a scene file: a fault.
    fn default() -> Self {
        Self::new(Source::Nothing)
    }
}

impl SharedCollider {
    pub(super) fn new(source: Source) -> Self {
        Self(Arc::new(Made {
            source,
            built: OnceLock::new(),
        }))
    }

    /// Whether it is this same shape of parry.
    #[cfg(feature = "rapier")]
    pub(crate) fn is_of(&self, shape: &SharedShape) -> bool {
        matches!(&self.0.source, Source::Parry(own) if Arc::ptr_eq(&own.0, &shape.0))
    }

    /// The shape under a scale. The first valid scale is built once and shared by all clones; any other is built each
    /// time.
    pub(crate) fn scaled(&self, scale: Vec3) -> Result<ColliderShape, ClothError> {
        check_scale(scale)?;
        let is_world_sized = matches!(self.0.source, Source::Parry(_));
        if let Some((first, built)) = self.0.built.get()
            // Two scales are equal up to the rounding of a transform.
            && (first.abs_diff_eq(scale, 1.0e-5 * first.length()) || is_world_sized)
        {
            return Ok(built.clone());
        }
        let built = self.0.source.build(scale)?;
        self.0.built.get_or_init(|| (scale, built.clone()));
        Ok(built)
    }

    /// Pose of its frame in the collider's frame, for poses inside a parry shape that ours do not have.
    pub(crate) fn offset(&self) -> Isometry3d {
        match &self.0.source {
            Source::Parry(shape) => {
                ColliderShape::of_parry(shape).map_or(Isometry3d::IDENTITY, |(pose, _)| pose)
            }
            _ => Isometry3d::IDENTITY,
        }
    }
}

impl Source {
    fn build(&self, scale: Vec3) -> Result<ColliderShape, ClothError> {
        let mut parts = Parts::default();
        match self {
            Self::Nothing => {
                return Err(ClothError::Shape(ShapeError::NoSuchShape {
                    shape: "points or triangles given in code, which a scene file cannot store"
                        .into(),
                }));
            }
            Self::Hull(points) => {
                let points: Vec<Vec3> = points.iter().map(|&point| point * scale).collect();
                parts.add_hull_of(&points)?;
            }
            Self::Triangles(vertices, triangles) => {
                let vertices = vertices.iter().map(|&vertex| vertex * scale).collect();
                parts.add_mesh(Pose::IDENTITY, (vertices, triangles.clone()), false)?;
            }
            Self::HeightField {
                heights,
                columns,
                size,
            } => {
                let ground = height_field(heights, *columns, *size * scale)?;
                parts.add_mesh(Pose::IDENTITY, ground, true)?;
            }
            Self::Parry(shape) => match ColliderShape::of_parry(shape) {
                Some((_, shape)) => return Ok(shape),
                None => parts.add(Pose::IDENTITY, shape)?,
            },
        }
        Ok(ColliderShape::Geometry(ColliderGeometry::of(parts)))
    }
}

/// Checks that a shape can have this scale.
///
/// # Errors
/// [`QuantityError`] for a scale that is zero or not finite.
pub(crate) fn check_scale(scale: Vec3) -> Result<(), QuantityError> {
    let is_scale = |scale: f32| scale != 0.0 && scale.is_finite();
    Allowed(is_scale, "finite and not zero").check("the shape's scale", scale.to_array())
}

/// The triangles of a height field: rows along z and columns along x, around the origin.
///
/// # Errors
/// [`ShapeError::HeightFieldSize`] unless there are at least two rows and columns, and a height at each crossing.
fn height_field(
    heights: &[f32],
    columns: usize,
    size: Vec3,
) -> Result<(Vec<Vec3>, Vec<[u32; 3]>), ShapeError> {
    let rows = heights.len().checked_div(columns).unwrap_or(0);
    if columns < 2 || rows < 2 || rows * columns != heights.len() {
        return Err(ShapeError::HeightFieldSize {
            heights: heights.len(),
            columns,
        });
    }
    let last = |count: usize| (count - 1) as f32;
    let vertices = heights.iter().enumerate().map(|(index, &height)| {
        let (row, column) = (index / columns, index % columns);
        let along = Vec3::new(
            column as f32 / last(columns) - 0.5,
            height,
            row as f32 / last(rows) - 0.5,
        );
        along * size
    });
    let vertices: Vec<Vec3> = vertices.collect();
    let mut triangles = Vec::with_capacity(2 * (rows - 1) * (columns - 1));
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let first = (row * columns + column) as u32;
            let below = first + columns as u32;
            triangles.extend([[first, below, first + 1], [first + 1, below, below + 1]]);
        }
    }
    turn_up(&vertices, &mut triangles);
    Ok((vertices, triangles))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An invalid scale does not affect a valid one.
    #[test]
    fn a_bad_scale_is_not_remembered() {
        let ball = SharedCollider::new(Source::Parry(SharedShape::ball(0.5)));
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let hull = SharedCollider::new(Source::Hull(corners));
        for shared in [ball, hull] {
            for bad in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
                assert!(shared.scaled(bad).is_err(), "{shared:?}");
            }
            let first = shared.scaled(Vec3::ONE).expect("a valid scale");
            assert_eq!(shared.clone().scaled(Vec3::ONE), Ok(first), "built once");
            assert!(shared.scaled(Vec3::ZERO).is_err(), "{shared:?}");
        }
    }
}
