//! Shapes of colliders, and the distance of a point from them.

use bevy::{
    math::{Isometry3d, Quat, Vec3},
    reflect::Reflect,
};
use parry3d::{
    math::Pose,
    shape::{Ball, Capsule, Cuboid, HalfSpace, Shape, SharedShape, TypedShape},
};

pub(crate) use super::nearest::Nearest;
use super::{
    boxes,
    deforming::DeformingMesh,
    geometry::{ColliderGeometry, SharpEdge},
};
use crate::hierarchy::Core;

/// The shape of a collider, scaled, in its own frame.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[non_exhaustive]
pub enum ColliderShape {
    /// A ball around the origin.
    Ball {
        /// Radius (m).
        radius: f32,
    },
    /// All points within a radius of a segment along the y axis.
    Capsule {
        /// Radius (m).
        radius: f32,
        /// Half of the segment's length (m).
        half_length: f32,
    },
    /// A box around the origin.
    Cuboid {
        /// Half of its side lengths (m).
        half_size: Vec3,
    },
    /// The half-space below the xz plane.
    HalfSpace,
    /// Any other rigid shape.
    Geometry(ColliderGeometry),
    /// A mesh that deforms.
    Deforming(DeformingMesh),
}

impl ColliderShape {
    /// A shape of parry that is one of these, with its pose; `None` for any other, which is a geometry.
    pub(super) fn of_parry(shape: &SharedShape) -> Option<(Isometry3d, Self)> {
        let along_y = |direction: Vec3| Quat::from_rotation_arc(Vec3::Y, direction);
        let (pose, shape) = match shape.as_typed_shape() {
            TypedShape::Ball(&Ball { radius }) => (Isometry3d::IDENTITY, Self::Ball { radius }),
            TypedShape::Cuboid(cuboid) => {
                let half_size = cuboid.half_extents;
                (Isometry3d::IDENTITY, Self::Cuboid { half_size })
            }
            TypedShape::Capsule(&Capsule { radius, segment }) => {
                let (a, b) = (segment.a, segment.b);
                let half_length = a.distance(b) / 2.0;
                let capsule = Self::Capsule {
                    radius,
                    half_length,
                };
                let along = (b - a).normalize_or(Vec3::Y);
                (Isometry3d::new(a.midpoint(b), along_y(along)), capsule)
            }
            TypedShape::HalfSpace(half) => {
                let rotation = along_y(half.normal.normalize_or(Vec3::Y));
                (Isometry3d::from_rotation(rotation), Self::HalfSpace)
            }
            _ => return None,
        };
        Some((pose, shape))
    }

    /// Visits the solids it is made of as shapes of parry, with their poses.
    pub(super) fn for_each_solid(&self, mut visit: impl FnMut(Pose, &dyn Shape)) {
        match *self {
            Self::Ball { radius } => visit(Pose::IDENTITY, &Ball::new(radius)),
            Self::Capsule {
                radius,
                half_length,
            } => visit(Pose::IDENTITY, &Capsule::new_y(half_length, radius)),
            Self::Cuboid { half_size } => visit(Pose::IDENTITY, &Cuboid::new(half_size)),
            Self::HalfSpace => visit(Pose::IDENTITY, &HalfSpace::new(Vec3::Y)),
            Self::Geometry(ref geometry) => geometry.for_each_solid(visit),
            // Bodies do not stand on it.
            Self::Deforming(_) => {}
        }
    }

    /// The shape in a pose, as a core and a radius around it. For a geometry, its bounding box; for a mesh that deforms, that of
    /// its whole path.
    pub fn core(&self, pose: Isometry3d) -> (Core, f32) {
        let centre = Vec3::from(pose.translation);
        match *self {
            Self::Geometry(_) | Self::Deforming(_) => {
                let [lower, upper] = self.bounds();
                let middle = centre + pose.rotation * lower.midpoint(upper);
                let pose = Isometry3d::new(middle, pose.rotation);
                let half_size = (upper - lower) / 2.0;
                (Core::Cuboid { pose, half_size }, 0.0)
            }
            Self::Ball { radius } => (Core::Point(centre), radius),
            Self::Capsule {
                radius,
                half_length,
            } => {
                let half = pose.rotation * Vec3::Y * half_length;
                (Core::Segment([centre - half, centre + half]), radius)
            }
            Self::Cuboid { half_size } => (Core::Cuboid { pose, half_size }, 0.0),
            Self::HalfSpace => {
                let normal = (pose.rotation * Vec3::Y).normalize_or(Vec3::Y);
                let point = centre;
                (Core::HalfSpace { point, normal }, 0.0)
            }
        }
    }

    /// The minimum and maximum corners of the bounding box of a geometry, or of a mesh that deforms along its path (m);
    /// without end for others.
    pub(crate) fn bounds(&self) -> [Vec3; 2] {
        match self {
            Self::Geometry(geometry) => geometry.bounds(),
            Self::Deforming(mesh) => mesh.bounds(),
            _ => [Vec3::NEG_INFINITY, Vec3::INFINITY],
        }
    }

    /// Largest displacement of a point of the surface in the tick, in the shape's frame (m): 0 for a rigid shape.
    pub(crate) fn deformation(&self) -> f32 {
        match self {
            Self::Deforming(mesh) => mesh.farthest_move(),
            _ => 0.0,
        }
    }

    /// Its size (m), as the extent of its core, the radius around that, and its thickness.
    #[inline]
    fn size(&self) -> (f32, Option<f32>, f32) {
        let corner = |[lower, upper]: [Vec3; 2]| lower.abs().max(upper.abs()).length();
        match *self {
            Self::Ball { radius } => (0.0, Some(radius), radius),
            Self::Capsule {
                radius,
                half_length,
            } => (half_length, Some(radius), radius),
            Self::Cuboid { half_size } => (half_size.length(), None, half_size.min_element()),
            Self::HalfSpace => (f32::INFINITY, None, f32::INFINITY),
            Self::Geometry(ref of) => (corner(of.bounds()), None, of.thickness()),
            Self::Deforming(ref mesh) => (corner(mesh.bounds()), None, 0.0),
        }
    }

    /// Distance from the origin to the farthest point of the shape (m); infinite for a half-space.
    pub fn extent(&self) -> f32 {
        self.core_extent() + self.radius().unwrap_or(0.0)
    }

    /// Distance from the origin to the farthest point of the core (m); infinite for a half-space.
    pub(crate) fn core_extent(&self) -> f32 {
        self.size().0
    }

    /// Smallest depth at which a point can be nearer to the other side (m); infinite for a half-space.
    pub fn thickness(&self) -> f32 {
        self.size().2
    }

    /// The radius for tests against triangles (m); only balls and capsules have one.
    pub fn radius(&self) -> Option<f32> {
        self.size().1
    }

    /// Whether the shape has edges that may pass through a triangle whose corners are all outside.
    pub fn has_edges(&self) -> bool {
        matches!(self, Self::Cuboid { .. } | Self::Geometry(_))
    }

    /// Whether its extent is infinite by what it is, and not by a fault.
    pub(crate) fn is_endless(&self) -> bool {
        matches!(self, Self::HalfSpace)
    }

    /// Whether its nearest point is expensive.
    pub(crate) fn is_geometry(&self) -> bool {
        matches!(self, Self::Geometry(_) | Self::Deforming(_))
    }

    /// The edge with an index of [`edges_near`](Self::edges_near).
    #[inline]
    pub(crate) fn edge(&self, index: u32) -> Option<SharpEdge> {
        match self {
            Self::Cuboid { half_size } => Some(boxes::edge(*half_size, index)),
            Self::Geometry(geometry) => Some(*geometry.edges().get(index)),
            _ => None,
        }
    }

    /// Visits the edges that may overlap a box of the shape's frame, with their indices, always in the same order; none
    /// of a surface with a radius of at least `smooth` (m).
    pub(crate) fn edges_near(
        &self,
        within: [Vec3; 2],
        smooth: f32,
        mut visit: impl FnMut(u32, &SharpEdge),
    ) {
        match self {
            Self::Cuboid { half_size } => {
                for index in 0..boxes::EDGES {
                    visit(index, &boxes::edge(*half_size, index));
                }
            }
            Self::Geometry(geometry) => geometry.edges().near(within, smooth, visit),
            _ => {}
        }
    }

    /// Distance of a point of the shape's frame from the nearest of these edges (m); infinite if none is within the given
    /// distance.
    pub(crate) fn edge_distance(&self, point: Vec3, within: f32, smooth: f32) -> f32 {
        match self {
            Self::Cuboid { half_size } => boxes::edge_distance(*half_size, point),
            Self::Geometry(geometry) => geometry.edges().distance(point, within, smooth),
            _ => f32::INFINITY,
        }
    }

    /// Distance at which the plane of a face of a box keeps points of its frame off it (m), at least; negative if none
    /// does. Other shapes have no such planes.
    #[inline]
    pub(crate) fn gap(&self, points: &[Vec3]) -> f32 {
        let Self::Cuboid { half_size } = *self else {
            return f32::NEG_INFINITY;
        };
        let (mut lower, mut upper) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &point in points {
            (lower, upper) = (lower.min(point), upper.max(point));
        }
        let beyond = (lower - half_size).max(-half_size - upper);
        // Smaller by rounding errors.
        beyond.max_element() - 1.0e-6 * (half_size + upper.abs().max(lower.abs())).max_element()
    }

    /// Distance of a point of its frame beside a height field, which is solid below its surface but nowhere else (m):
    /// having moved by this, the point may be deep inside. Infinite if it is beside none.
    pub(crate) fn distance_beside_ground(&self, point: Vec3) -> f32 {
        match self {
            Self::Geometry(geometry) => geometry.distance_beside_ground(point),
            _ => f32::INFINITY,
        }
    }

    /// The surface nearest to a point of its frame, probably within a distance (m).
    pub(crate) fn nearest_within(&self, point: Vec3, within: f32) -> Nearest {
        match self {
            Self::Geometry(geometry) => geometry.nearest(point, within),
            _ => self.nearest(Isometry3d::IDENTITY, point),
        }
    }

    /// The surface nearest to a point, with the shape in a pose; of a mesh that deforms, as the tick ends.
    #[inline]
    pub(crate) fn nearest(&self, pose: Isometry3d, point: Vec3) -> Nearest {
        let offset = point - Vec3::from(pose.translation);
        let local = || pose.rotation.inverse() * offset;
        match *self {
            Self::Geometry(ref of) => of.nearest(local(), f32::MAX).turned(pose.rotation),
            Self::Deforming(ref mesh) => mesh.nearest(1.0, local()).turned(pose.rotation),
            Self::Ball { radius } => around(offset, radius),
            Self::Capsule {
                radius,
                half_length,
            } => {
                let axis = pose.rotation * Vec3::Y;
                let along = offset.dot(axis).clamp(-half_length, half_length);
                around(offset - axis * along, radius)
            }
            Self::Cuboid { half_size } => {
                let local = local();
                let outside = local - local.clamp(-half_size, half_size);
                let (distance, normal) = if outside == Vec3::ZERO {
                    let left = half_size - local.abs();
                    let axis = left.min_position();
                    let mut normal = Vec3::ZERO;
                    normal[axis] = 1.0_f32.copysign(local[axis]);
                    (-left[axis], normal)
                } else {
                    let distance = outside.length();
                    (distance, outside / distance)
                };
                Nearest { distance, normal }.turned(pose.rotation)
            }
            Self::HalfSpace => {
                let normal = (pose.rotation * Vec3::Y).normalize_or(Vec3::Y);
                let distance = offset.dot(normal);
                Nearest { distance, normal }
            }
        }
    }
}

fn around(offset: Vec3, radius: f32) -> Nearest {
    let distance = offset.length();
    // A particle exactly at the centre may leave in any direction.
    let away = offset / distance;
    let normal = if distance > 0.0 { away } else { Vec3::Y };
    Nearest {
        distance: distance - radius,
        normal,
    }
}
