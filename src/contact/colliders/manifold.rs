//! The points at which two colliders are nearest to each other, by parry.

use bevy::math::{Isometry3d, Vec3};
use parry3d::{
    math::Pose,
    query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher},
    shape::{PackedFeatureId, PolygonalFeature, Shape},
};

use super::shape::ColliderShape;

/// A point of a contact manifold.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct ManifoldPoint {
    /// The points on the first and the second shape, each in its shape's frame (m).
    pub on_first: Vec3,
    pub on_second: Vec3,
    /// Normal out of the first shape, in its frame, of length 1.
    pub normal: Vec3,
    /// Distance along it (m).
    distance: f32,
}

impl ManifoldPoint {
    /// A point on the way to another one, with the same normal.
    pub fn lerp(&self, other: &Self, part: f32) -> Self {
        Self {
            on_first: self.on_first.lerp(other.on_first, part),
            on_second: self.on_second.lerp(other.on_second, part),
            ..*self
        }
    }
}

/// Most points: those of a mesh lie at each of its triangles.
pub(crate) const MOST_POINTS: usize = 8;

/// The contact manifold of two shapes.
#[derive(Debug, Default, Clone)]
pub(crate) struct Manifold {
    pub points: Vec<ManifoldPoint>,
    /// Memory for a pair of convex solids, and for other pairs.
    pair: ContactManifold<(), ()>,
    pairs: Vec<ContactManifold<(), ()>>,
}

impl Manifold {
    /// Finds where two shapes are within a distance of each other (m), at eight points at most. `between` is the second
    /// one's pose in the frame of the first. Convex shapes allocate nothing after the first time; meshes do, in parry.
    pub fn find(&mut self, [a, b]: [&ColliderShape; 2], between: Isometry3d, within: f32) {
        self.points.clear();
        let between = Pose::from_parts(between.translation.into(), between.rotation);
        a.for_each_solid(|at, solid| {
            b.for_each_solid(|other_at, other| {
                let between = at.inverse() * between * other_at;
                self.find_between([solid, other], [at, other_at], between, within);
            });
        });
        if self.points.len() > MOST_POINTS {
            self.thin_out();
        }
    }

    /// The mean of its points.
    pub fn middle(&self) -> ManifoldPoint {
        let part = 1.0 / self.points.len().max(1) as f32;
        let mut middle = ManifoldPoint::default();
        for point in &self.points {
            middle.on_first += point.on_first * part;
            middle.on_second += point.on_second * part;
        }
        middle
    }

    /// Keeps the deepest point, and those that are farthest from each other.
    fn thin_out(&mut self) {
        let distance = |at: usize| self.points[at].distance;
        let by_distance = |a: &usize, b: &usize| distance(*a).total_cmp(&distance(*b));
        if let Some(deepest) = (0..self.points.len()).min_by(by_distance) {
            self.points.swap(0, deepest);
        }
        for kept in 1..self.points.len().min(MOST_POINTS) {
            let apart = |at: usize| {
                let others = self.points[..kept].iter().map(|other| other.on_second);
                let squares = others.map(|other| other.distance_squared(self.points[at].on_second));
                squares.fold(f32::INFINITY, f32::min)
            };
            let by_apart = |a: &usize, b: &usize| apart(*a).total_cmp(&apart(*b));
            let farthest = (kept..self.points.len()).max_by(by_apart);
            self.points.swap(kept, farthest.unwrap_or(kept));
        }
        self.points.truncate(MOST_POINTS);
    }

    fn find_between(
        &mut self,
        [solid, other]: [&dyn Shape; 2],
        at: [Pose; 2],
        between: Pose,
        within: f32,
    ) {
        if let (Some(plane), Some((corners, radius))) =
            (solid.as_halfspace(), other.as_polygonal_feature_map())
        {
            // As parry finds them, which makes a new list each time.
            let mut face = PolygonalFeature::default();
            let normal = between.rotation.inverse() * plane.normal;
            corners.local_support_feature(-normal, &mut face);
            for corner in &face.vertices[..face.num_vertices] {
                let place = between * *corner;
                let height = place.dot(plane.normal);
                if height - radius <= within {
                    self.points.push(ManifoldPoint {
                        on_first: at[0] * (place - plane.normal * height),
                        on_second: at[1] * (*corner - normal * radius),
                        normal: at[0].rotation * plane.normal,
                        distance: height - radius,
                    });
                }
            }
            return;
        }
        let parry = DefaultQueryDispatcher;
        // An earlier search must not change the next one.
        self.pair.points.clear();
        (self.pair.local_n1, self.pair.local_n2) = (Vec3::ZERO, Vec3::ZERO);
        self.pairs.clear();
        let pair = &mut self.pair;
        let is_convex = parry
            .contact_manifold_convex_convex(&between, solid, other, None, None, within, pair)
            .is_ok();
        if !is_convex
            && parry
                .contact_manifolds(&between, solid, other, within, &mut self.pairs, &mut None)
                .is_err()
        {
            return;
        }
        for manifold in std::iter::once(&self.pair).chain(&self.pairs) {
            // Beside the corners of a common face, parry adds the point at which its search ended.
            let has_corners = manifold.points.len() > 3;
            let near = manifold.points.iter().filter(|point| {
                let is_corner = point.fid1 != PackedFeatureId::UNKNOWN;
                point.dist <= within && (is_corner || !has_corners)
            });
            self.points.extend(near.map(|point| ManifoldPoint {
                on_first: at[0] * point.local_p1,
                on_second: at[1] * point.local_p2,
                normal: at[0].rotation * manifold.local_n1,
                distance: point.dist,
            }));
        }
    }
}
