//! A part of a geometry, and its nearest point.

use std::sync::Arc;

use bevy::math::Vec3;
use parry3d::{
    math::Pose,
    query::PointQueryWithLocation,
    shape::{SharedShape, TriMesh},
};

use crate::contact::colliders::nearest::Nearest;

/// Half of the thickness of a two-sided mesh (m): without it, a point exactly on the mesh would have no side.
pub(crate) const HALF_SHEET: f32 = 0.0005;

/// A part for tests against particles.
#[derive(Debug, Clone)]
pub(crate) struct Solid {
    pub pose: Pose,
    /// Bounding box in the frame of the whole (m).
    pub bounds: [Vec3; 2],
    pub kind: SolidKind,
}

#[derive(Debug, Clone)]
pub(crate) enum SolidKind {
    /// A convex shape, whose nearest point parry computes.
    Convex(SharedShape),
    Mesh(Arc<TriMesh>, MeshSides),
}

/// The inside of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MeshSides {
    /// Its volume: it has an outer side only.
    Closed,
    /// Nothing: it is open, and has two sides.
    Open,
    /// Everything below it.
    Ground,
}

impl Solid {
    /// Number of triangles, if it is a mesh.
    pub fn triangles(&self) -> usize {
        match &self.kind {
            SolidKind::Convex(_) => 0,
            SolidKind::Mesh(mesh, _) => mesh.num_triangles(),
        }
    }

    pub fn is_open(&self) -> bool {
        matches!(&self.kind, SolidKind::Mesh(_, MeshSides::Open))
    }

    pub fn is_ground(&self) -> bool {
        matches!(&self.kind, SolidKind::Mesh(_, MeshSides::Ground))
    }

    /// Smallest depth at which a point can be nearer to the other side (m).
    pub fn thickness(&self) -> f32 {
        match &self.kind {
            SolidKind::Convex(shape) => shape.ccd_thickness(),
            SolidKind::Mesh(_, MeshSides::Open) => HALF_SHEET,
            SolidKind::Mesh(_, MeshSides::Closed | MeshSides::Ground) => 0.0,
        }
    }

    /// Distance of a point beside the ground (m): beyond its extent, nothing is below it. Infinite for others.
    pub fn distance_beside_ground(&self, point: Vec3) -> f32 {
        let SolidKind::Mesh(mesh, MeshSides::Ground) = &self.kind else {
            return f32::INFINITY;
        };
        let (local, bounds) = (self.pose.inverse_transform_point(point), mesh.local_aabb());
        let within = local.clamp(bounds.mins, bounds.maxs).with_y(local.y);
        match local.distance(within) {
            0.0 => f32::INFINITY,
            distance => distance,
        }
    }

    /// The surface nearest to a point; of a mesh only within a distance (m).
    pub fn nearest(&self, point: Vec3, within: f32) -> Option<Nearest> {
        let local = self.pose.inverse_transform_point(point);
        let mut nearest = match &self.kind {
            SolidKind::Convex(shape) => {
                let projection = shape.project_local_point(local, false);
                let fallback = local.normalize_or(Vec3::Y);
                towards(local, projection.point, projection.is_inside, fallback)
            }
            SolidKind::Mesh(mesh, sides) => nearest_of_mesh(mesh, *sides, local, within)?,
        };
        nearest.normal = self.pose.rotation * nearest.normal;
        Some(nearest)
    }
}

fn nearest_of_mesh(mesh: &TriMesh, sides: MeshSides, point: Vec3, within: f32) -> Option<Nearest> {
    let (projection, (face, _)) =
        mesh.project_local_point_and_get_location_with_max_dist(point, false, within)?;
    let bounds = mesh.local_aabb();
    let is_inside = match sides {
        MeshSides::Closed => projection.is_inside,
        MeshSides::Open => false,
        // Outside its extent, nothing is below it.
        MeshSides::Ground => {
            let beside = point.clamp(bounds.mins, bounds.maxs).with_y(point.y);
            projection.is_inside && beside == point
        }
    };
    let fallback = mesh.triangle(face).scaled_normal().normalize_or(Vec3::Y);
    let mut nearest = towards(point, projection.point, is_inside, fallback);
    if sides == MeshSides::Open {
        nearest.distance -= HALF_SHEET;
    }
    Some(nearest)
}

/// The [`Nearest`] of a point to a surface whose nearest point is known. `fallback` is the normal of a point on the
/// surface.
pub(in crate::contact::colliders) fn towards(
    point: Vec3,
    surface: Vec3,
    is_inside: bool,
    fallback: Vec3,
) -> Nearest {
    let offset = point - surface;
    let distance = offset.length();
    // A shorter distance is only rounding.
    if distance <= 1.0e-6 * point.length().max(1.0e-3) {
        return Nearest {
            distance: 0.0,
            normal: fallback,
        };
    }
    let away = offset / distance;
    let (distance, normal) = match is_inside {
        true => (-distance, -away),
        false => (distance, away),
    };
    Nearest { distance, normal }
}
