//! Colliders for cloth.

mod compound;

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::{Isometry3d, Quat, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::components::Transform,
};
use parry3d::{math::Pose, shape::SharedShape};

use super::{
    geometry::{ColliderGeometry, Parts},
    shape::ColliderShape,
    source::{SharedCollider, Source},
};
use crate::cloth::{Allowed, ClothError, MeshError};

/// A length under a scale, checked before and after scaling. Errors name it as that `of` a shape.
macro_rules! length {
    ($of:literal, $name:literal, $value:expr, $scale:expr) => {{
        let scaled = $value * $scale;
        Allowed::LENGTH.check(concat!($of, " ", $name), [$value])?;
        Allowed::LENGTH.check(concat!($of, " scaled ", $name), [scaled])?;
        scaled
    }};
}

/// A collider for cloth at the entity's [`Transform`]. Every cloth collides with it, unless
/// [`ClothLayers`](crate::contact::ClothLayers) exclude it. Move it however you like. Cloth pushes it back only if it has a
/// [`ClothBody`](crate::plugin::ClothBody).
///
/// Its velocity, and so its friction, comes from the change of its transform since the last tick. Move it in the
/// cloth's schedule, before [`ClothSystems::Prepare`](crate::plugin::ClothSystems). To teleport it without a velocity,
/// insert [`ClothTeleport`](crate::plugin::ClothTeleport).
///
/// Fast colliders do not tunnel: if one moves farther in a sub-step than half of its thickness, it is tested along its
/// whole path.
///
/// # Scale
/// The transform's scale applies to all shapes, also if it is not uniform. A ball stays a ball, by the largest axis.
/// Capsule, cylinder and cone stay round, by the larger of x and z. Points, meshes and height fields take any scale. A
/// negative scale mirrors: symmetric shapes do not change, a cone points down, and a mesh is mirrored and keeps its
/// outer side. A compound with a rotated part needs a uniform scale. No scale may be zero.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// let table = ClothCollider::cylinder(0.6, 0.05);
/// let stone = ClothCollider::convex_hull(vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]);
/// let stool = ClothCollider::compound([
///     (Isometry3d::from_xyz(0.0, 0.5, 0.0), ClothCollider::cuboid(0.4, 0.04, 0.4)),
///     (Isometry3d::from_xyz(0.0, 0.24, 0.0), ClothCollider::cylinder(0.05, 0.48)),
/// ]);
/// let head = ClothCollider::from(Sphere::new(0.12));
/// # let _ = (table, stone, stool, head);
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
#[non_exhaustive]
pub enum ClothCollider {
    /// A ball.
    Ball {
        /// Radius (m), before the transform's scale.
        radius: f32,
    },
    /// A capsule along the entity's y axis, like Bevy's `Capsule3d`.
    Capsule {
        /// Radius (m), before the transform's scale.
        radius: f32,
        /// Half of the length between the centres of its two half-balls (m), before the transform's scale.
        half_length: f32,
    },
    /// A box, like Bevy's `Cuboid`.
    Cuboid {
        /// Half of its side lengths (m), before the transform's scale.
        half_size: Vec3,
    },
    /// The half-space below a plane, whose normal is the entity's y axis.
    Plane,
    /// A cylinder along the entity's y axis, like Bevy's `Cylinder`.
    Cylinder {
        /// Radius (m), before the transform's scale.
        radius: f32,
        /// Half of its height (m), before the transform's scale.
        half_height: f32,
    },
    /// A cone along the entity's y axis with its tip up, like Bevy's `Cone`. Its origin is at half its height.
    Cone {
        /// Radius of its base (m), before the transform's scale.
        radius: f32,
        /// Half of its height (m), before the transform's scale.
        half_height: f32,
    },
    /// The entity's `Mesh3d`, once it has loaded, with the joints of a `SkinnedMesh`; needs feature `mesh`.
    Mesh(MeshCollider),
    /// Several shapes, each with a pose in the entity's frame (m).
    Compound(Vec<(Isometry3d, Self)>),
    /// Points, triangles or heights given in code. They cannot be serialized: loaded from a scene file, the collider
    /// raises a [`ClothFault`](crate::plugin::ClothFault).
    Shared(#[reflect(ignore)] SharedCollider),
}

/// The shape made from a mesh.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
#[non_exhaustive]
pub enum MeshCollider {
    /// Its triangles. A closed mesh has an outer side only; an open mesh has two sides. A skinned mesh has an outer side, open or
    /// closed: the one from which the corners of a triangle run counter-clockwise.
    #[default]
    Triangles,
    /// The convex hull of its vertices: cheaper, and exact for a convex mesh. It is rigid, even if the mesh is skinned.
    Hull,
}

impl Default for ClothCollider {
    /// The paper's ball, of radius 1.
    fn default() -> Self {
        Self::ball(1.0)
    }
}

impl ClothCollider {
    /// A ball of `radius` (m).
    pub const fn ball(radius: f32) -> Self {
        Self::Ball { radius }
    }

    /// A capsule of `radius`, with `length` between the centres of its two half-balls (m).
    pub const fn capsule(radius: f32, length: f32) -> Self {
        Self::Capsule {
            radius,
            half_length: length / 2.0,
        }
    }

    /// A box with these side lengths (m).
    pub const fn cuboid(x: f32, y: f32, z: f32) -> Self {
        Self::Cuboid {
            half_size: Vec3::new(x / 2.0, y / 2.0, z / 2.0),
        }
    }

    /// The half-space below the entity's xz plane.
    pub const fn plane() -> Self {
        Self::Plane
    }

    /// A cylinder of `radius` and `height` (m).
    pub const fn cylinder(radius: f32, height: f32) -> Self {
        Self::Cylinder {
            radius,
            half_height: height / 2.0,
        }
    }

    /// A cone of `height` with a base of `radius` (m).
    pub const fn cone(radius: f32, height: f32) -> Self {
        Self::Cone {
            radius,
            half_height: height / 2.0,
        }
    }

    /// The convex hull of points (m), which must not all lie in one plane.
    pub fn convex_hull(points: impl Into<Vec<Vec3>>) -> Self {
        Self::Shared(SharedCollider::new(Source::Hull(points.into())))
    }

    /// Triangles between vertices (m). A closed mesh, with two triangles at each edge, is solid, whatever its winding
    /// order. An open mesh is a sheet 1 mm thick, which cloth touches from both sides. Vertices at the same position
    /// are merged.
    ///
    /// Built once and shared by all clones.
    pub fn trimesh(vertices: impl Into<Vec<Vec3>>, triangles: impl Into<Vec<[u32; 3]>>) -> Self {
        let source = Source::Triangles(vertices.into(), triangles.into());
        Self::Shared(SharedCollider::new(source))
    }

    /// A height field around the entity's origin. `heights` are row by row: rows lie along z, with `columns` heights
    /// along x. `size` (m) is its extent along x and z, and in y the scale of the heights. Everything below it is
    /// inside.
    pub fn heightfield(heights: impl Into<Vec<f32>>, columns: usize, size: Vec3) -> Self {
        Self::Shared(SharedCollider::new(Source::HeightField {
            heights: heights.into(),
            columns,
            size,
        }))
    }

    /// Several shapes as one, each with a pose in the entity's frame (m). Planes and meshes from an asset cannot be
    /// parts.
    pub fn compound(parts: impl IntoIterator<Item = (Isometry3d, Self)>) -> Self {
        Self::Compound(parts.into_iter().collect())
    }

    /// The triangles of the entity's `Mesh3d`, once it has loaded. They follow the joints of a `SkinnedMesh`.
    pub const fn mesh() -> Self {
        Self::Mesh(MeshCollider::Triangles)
    }

    /// The convex hull of the entity's `Mesh3d`, once it has loaded.
    pub const fn mesh_hull() -> Self {
        Self::Mesh(MeshCollider::Hull)
    }

    /// A shape of parry, the geometry library of rapier. It ignores the transform's scale.
    pub fn parry(shape: SharedShape) -> Self {
        Self::Shared(SharedCollider::new(Source::Parry(shape)))
    }

    /// Pose of the shape's frame in the entity's frame: the identity, except for shapes from parry.
    pub fn offset(&self) -> Isometry3d {
        match self {
            Self::Shared(shared) => shared.offset(),
            _ => Isometry3d::IDENTITY,
        }
    }

    /// Returns the shape under a transform's `scale`. A ball takes the largest axis, and so does the radius of a
    /// capsule.
    ///
    /// # Errors
    /// [`QuantityError`](crate::cloth::QuantityError) for a length that is zero, negative or not finite, before or after
    /// scaling; a capsule's length may be zero. [`MeshError::NotLoaded`] for a mesh, because only the plugin can access the assets.
    /// Errors of points, triangles, heights or parts.
    pub fn scaled(&self, scale: Vec3) -> Result<ColliderShape, ClothError> {
        let sizes = scale.abs();
        // The scale of a radius about the y axis.
        let across = sizes.x.max(sizes.z);
        match *self {
            Self::Shared(ref shared) => shared.scaled(scale),
            Self::Compound(ref parts) => {
                let part = |(pose, of): &(Isometry3d, Self)| (*pose, of.offset(), of.scaled(scale));
                compound::scaled(parts.iter().map(part), scale)
            }
            Self::Mesh(_) => Err(MeshError::NotLoaded.into()),
            Self::Cylinder {
                radius,
                half_height,
            } => {
                let radius = length!("the cylinder's", "radius (m)", radius, across);
                let half_height =
                    length!("half of the cylinder's", "height (m)", half_height, sizes.y);
                convex(Pose::IDENTITY, &SharedShape::cylinder(half_height, radius))
            }
            Self::Cone {
                radius,
                half_height,
            } => {
                let radius = length!("the cone's", "radius (m)", radius, across);
                let half_height = length!("half of the cone's", "height (m)", half_height, sizes.y);
                let over = Pose::from_rotation(Quat::from_rotation_x(std::f32::consts::PI));
                let pose = if scale.y > 0.0 { Pose::IDENTITY } else { over };
                convex(pose, &SharedShape::cone(half_height, radius))
            }
            Self::Ball { radius } => {
                let radius = length!("the ball's", "radius (m)", radius, sizes.max_element());
                Ok(ColliderShape::Ball { radius })
            }
            Self::Capsule {
                radius,
                half_length,
            } => {
                let radius = length!("the capsule's", "radius (m)", radius, across);
                let half_length = half_length * sizes.y;
                let size = Allowed(|v| v >= 0.0 && v.is_finite(), "zero or more");
                size.check("half of the capsule's scaled length (m)", [half_length])?;
                Ok(ColliderShape::Capsule {
                    radius,
                    half_length,
                })
            }
            Self::Cuboid { half_size } => {
                for axis in 0..3 {
                    length!(
                        "half of the box's",
                        "length (m)",
                        half_size[axis],
                        sizes[axis]
                    );
                }
                Ok(ColliderShape::Cuboid {
                    half_size: half_size * sizes,
                })
            }
            Self::Plane => Ok(ColliderShape::HalfSpace),
        }
    }
}

/// A convex shape of parry with a pose.
fn convex(pose: Pose, shape: &SharedShape) -> Result<ColliderShape, ClothError> {
    let mut parts = Parts::default();
    parts.add(pose, shape)?;
    Ok(ColliderShape::Geometry(ColliderGeometry::of(parts)))
}

#[cfg(test)]
mod tests;
