//! Complex shapes: solids, meshes, and compounds.

mod edges;
mod mesh;
mod parts;
mod solid;

use std::sync::Arc;

use super::nearest::Nearest;
use bevy::{math::Vec3, reflect::Reflect};
#[cfg(feature = "mesh")]
pub(super) use edges::MeshEdges;
pub(crate) use edges::SharpEdge;
use edges::SharpEdges;
#[cfg(feature = "mesh")]
pub(super) use mesh::{check_triangles, volume};
use parry3d::{math::Pose, shape::Shape};
pub(crate) use parts::{Parts, turn_up};
pub(super) use solid::towards;
use solid::{Solid, SolidKind};

/// A cylinder, cone, convex hull, triangle mesh, height field or compound, scaled, in its own frame, with precomputed
/// data. Clones share the data. Two geometries are equal if they are clones of each other.
#[derive(Reflect, Debug, Clone)]
#[type_path = "bevy_drape"]
#[reflect(opaque, Debug, Clone, PartialEq)]
pub struct ColliderGeometry(Arc<Geometry>);

impl PartialEq for ColliderGeometry {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[derive(Debug)]
struct Geometry {
    /// Solids for tests against particles.
    solids: Vec<Solid>,
    /// Edges for tests against triangles.
    edges: SharpEdges,
    /// Bounding box (m).
    bounds: [Vec3; 2],
    /// Smallest depth at which a point can be nearer to the other side (m).
    thickness: f32,
}

impl ColliderGeometry {
    /// Builds it from one or more parts.
    pub(crate) fn of(parts: Parts) -> Self {
        let Parts { solids, edges } = parts;
        let boxes = solids.iter().map(|solid| solid.bounds);
        let bounds = boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        let thickness = solids.iter().map(Solid::thickness);
        let thickness = thickness.fold(f32::INFINITY, f32::min);
        Self(Arc::new(Geometry {
            edges: SharpEdges::of(edges),
            solids,
            bounds: bounds.unwrap_or_default(),
            thickness,
        }))
    }

    /// The minimum and maximum corners of its bounding box (m).
    pub fn bounds(&self) -> [Vec3; 2] {
        self.0.bounds
    }

    /// Number of triangles of its meshes.
    pub fn triangles(&self) -> usize {
        self.0.solids.iter().map(Solid::triangles).sum()
    }

    /// Whether any part is an open mesh, which has two sides.
    pub fn is_two_sided(&self) -> bool {
        self.0.solids.iter().any(Solid::is_open)
    }

    pub(crate) fn thickness(&self) -> f32 {
        self.0.thickness
    }

    /// Visits its solids, with their poses.
    pub(crate) fn for_each_solid(&self, mut visit: impl FnMut(Pose, &dyn Shape)) {
        for solid in &self.0.solids {
            match &solid.kind {
                SolidKind::Convex(shape) => visit(solid.pose, &**shape),
                SolidKind::Mesh(mesh, _) => visit(solid.pose, &**mesh),
            }
        }
    }

    /// Its parts, for another geometry.
    pub(crate) fn parts(&self) -> Parts {
        Parts {
            solids: self.0.solids.clone(),
            edges: self.0.edges.all.clone(),
        }
    }

    /// The surface nearest to a point, of the deepest or nearest solid, which is probably `within` a distance (m): that
    /// makes it faster. NaN for a point that is not finite.
    pub(crate) fn nearest(&self, point: Vec3, within: f32) -> Nearest {
        // A point that moves from beside a height field to above it may at once be as deep as the ground is high.
        let is_alone = self.0.solids.len() == 1;
        if is_alone || !self.0.solids.iter().any(Solid::is_ground) {
            let found = self.find_nearest(point, within);
            // A mesh farther away was not found, but another part may have been. False for NaN.
            if found.distance <= within {
                return found;
            }
        }
        self.find_nearest(point, f32::MAX)
    }

    fn find_nearest(&self, point: Vec3, within: f32) -> Nearest {
        let mut found = Nearest {
            distance: f32::MAX,
            normal: Vec3::Y,
        };
        for solid in &self.0.solids {
            let [lower, upper] = solid.bounds;
            let beyond = point.distance_squared(point.clamp(lower, upper));
            if found.distance < f32::MAX && beyond > found.distance.max(0.0).powi(2) {
                continue;
            }
            if let Some(nearest) = solid.nearest(point, within)
                && nearest.distance < found.distance
            {
                found = nearest;
            }
        }
        found
    }

    /// Distance of a point beside its height fields, if it is beside any (m); else infinite.
    pub(crate) fn distance_beside_ground(&self, point: Vec3) -> f32 {
        let solids = self.0.solids.iter();
        let each = solids.map(|solid| solid.distance_beside_ground(point));
        each.fold(f32::INFINITY, f32::min)
    }

    /// Its edges.
    #[inline]
    pub(super) fn edges(&self) -> &SharpEdges {
        &self.0.edges
    }
}
