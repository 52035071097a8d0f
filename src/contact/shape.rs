//! Shapes that a cloth can touch, and how far a point is from them.

use bevy::{
    math::{Isometry3d, Vec3},
    reflect::Reflect,
};

pub(super) use super::nearest::Nearest;
use super::{
    boxes,
    geometry::{ColliderGeometry, SharpEdge},
};
use crate::hierarchy::Core;

/// The shape of a collider, scaled, in its own frame.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ColliderShape {
    /// A ball around the origin.
    Ball {
        /// Radius (m).
        radius: f32,
    },
    /// All that is nearer than a radius to a segment along the y axis.
    Capsule {
        /// Radius (m).
        radius: f32,
        /// Half of the segment's length (m).
        half_length: f32,
    },
    /// A box around the origin.
    Cuboid {
        /// Half of its lengths (m).
        half_size: Vec3,
    },
    /// All below the plane through the origin whose normal is the y axis.
    HalfSpace,
    /// Anything else.
    Geometry(ColliderGeometry),
}

impl ColliderShape {
    /// The shape in a pose, as the neighbourhood of a core; of a geometry, the box around it.
    pub fn core(&self, pose: Isometry3d) -> (Core, f32) {
        let centre = Vec3::from(pose.translation);
        match *self {
            Self::Geometry(ref geometry) => {
                let [lower, upper] = geometry.bounds();
                let pose = Isometry3d::new(
                    centre + pose.rotation * lower.midpoint(upper),
                    pose.rotation,
                );
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
                (
                    Core::HalfSpace {
                        point: centre,
                        normal,
                    },
                    0.0,
                )
            }
        }
    }

    /// Distance from the origin to what is farthest from it (m); infinite for a half-space.
    pub fn extent(&self) -> f32 {
        match *self {
            Self::Ball { radius } => radius,
            Self::Capsule {
                radius,
                half_length,
            } => radius + half_length,
            Self::Cuboid { half_size } => half_size.length(),
            Self::HalfSpace => f32::INFINITY,
            Self::Geometry(ref geometry) => {
                let [lower, upper] = geometry.bounds();
                lower.abs().max(upper.abs()).length()
            }
        }
    }

    /// Distance from the origin to what is farthest from it in the core (m); infinite for a half-space.
    pub(super) fn core_extent(&self) -> f32 {
        match *self {
            Self::Ball { .. } => 0.0,
            Self::Capsule { half_length, .. } => half_length,
            Self::Cuboid { .. } | Self::HalfSpace | Self::Geometry(_) => self.extent(),
        }
    }

    /// How deep a point may get without being nearer to the other side (m); infinite for a half-space.
    pub fn thickness(&self) -> f32 {
        match *self {
            Self::Ball { radius } | Self::Capsule { radius, .. } => radius,
            Self::Cuboid { half_size } => half_size.min_element(),
            Self::HalfSpace => f32::INFINITY,
            Self::Geometry(ref geometry) => geometry.thickness(),
        }
    }

    /// The radius that triangles are tested against (m); only balls and capsules have one.
    pub fn radius(&self) -> Option<f32> {
        match *self {
            Self::Ball { radius } | Self::Capsule { radius, .. } => Some(radius),
            Self::Cuboid { .. } | Self::HalfSpace | Self::Geometry(_) => None,
        }
    }

    /// Whether it has edges that may come through a triangle whose corners are all outside.
    pub fn has_edges(&self) -> bool {
        matches!(self, Self::Cuboid { .. } | Self::Geometry(_))
    }

    /// One of its edges, as [`edges_near`](Self::edges_near) numbers them.
    #[inline]
    pub(super) fn edge(&self, index: u32) -> Option<SharpEdge> {
        match self {
            Self::Cuboid { half_size } => Some(boxes::edge(*half_size, index)),
            Self::Geometry(geometry) => Some(geometry.edge(index)),
            Self::Ball { .. } | Self::Capsule { .. } | Self::HalfSpace => None,
        }
    }

    /// Hands out the edges that may come into a box of the shape's frame, with their numbers: always in the same order.
    pub(super) fn edges_near(&self, within: [Vec3; 2], mut visit: impl FnMut(u32, &SharpEdge)) {
        match self {
            Self::Cuboid { half_size } => {
                for index in 0..boxes::EDGES {
                    visit(index, &boxes::edge(*half_size, index));
                }
            }
            Self::Geometry(geometry) => geometry.edges_near(within, visit),
            Self::Ball { .. } | Self::Capsule { .. } | Self::HalfSpace => {}
        }
    }

    /// How far a point of the shape's frame is from its nearest edge (m); infinite if none is within so far.
    pub(super) fn edge_distance(&self, point: Vec3, within: f32) -> f32 {
        match self {
            Self::Cuboid { half_size } => boxes::edge_distance(*half_size, point),
            Self::Geometry(geometry) => geometry.edge_distance(point, within),
            Self::Ball { .. } | Self::Capsule { .. } | Self::HalfSpace => f32::INFINITY,
        }
    }

    /// How a point lies to the shape in a pose.
    #[inline]
    pub(super) fn nearest(&self, pose: Isometry3d, point: Vec3) -> Nearest {
        let offset = point - Vec3::from(pose.translation);
        match *self {
            Self::Geometry(ref geometry) => {
                let nearest = geometry.nearest(pose.rotation.inverse() * offset);
                Nearest {
                    normal: pose.rotation * nearest.normal,
                    ..nearest
                }
            }
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
                let local = pose.rotation.inverse() * offset;
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
                Nearest {
                    distance,
                    normal: pose.rotation * normal,
                }
            }
            Self::HalfSpace => {
                let normal = (pose.rotation * Vec3::Y).normalize_or(Vec3::Y);
                Nearest {
                    distance: offset.dot(normal),
                    normal,
                }
            }
        }
    }
}

fn around(offset: Vec3, radius: f32) -> Nearest {
    let distance = offset.length();
    // A particle in the very centre may leave either way.
    let normal = if distance > 0.0 {
        offset / distance
    } else {
        Vec3::Y
    };
    Nearest {
        distance: distance - radius,
        normal,
    }
}
