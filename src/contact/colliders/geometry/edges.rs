//! The sharp edges of a shape: they may pass through a triangle of the cloth whose corners are all outside.

use std::f32::consts::FRAC_1_SQRT_2;

use bevy::math::Vec3;
use parry3d::{
    bounding_volume::Aabb,
    partitioning::{Bvh, BvhBuildStrategy, BvhNode},
    query::PointQuery,
};

/// Below this angle (sine), two faces have no edge between them.
const SHARP: f32 = 1.0e-3;

/// From this sine of half the angle between the normals of its faces on, an edge touches at the full distance; below, at a
/// fraction in proportion, and at this one at least. A side of a triangle of length l across an edge of half an angle φ,
/// with its ends at a distance r off the faces, is still r − l/2 tan φ off the edge.
const SHARP_ENOUGH: f32 = 0.5;
const LEAST_PART: f32 = 0.4;

/// An edge of a shape, or the axis of a rounded part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SharpEdge {
    /// Its ends (m).
    pub ends: [Vec3; 2],
    /// Direction between the normals of the adjacent faces, of length 1; 0 without an inner side.
    pub outward: Vec3,
    /// Radius of the shape around the line (m).
    pub radius: f32,
    /// Smallest radius of the round surface that it is a line of (m); 0 for a sharp edge.
    pub round: f32,
    /// It touches at this fraction of the usual distance. Across a blunt edge, particles on its faces keep triangles off
    /// by themselves.
    pub part: f32,
}

/// The edges of a shape in a tree.
#[derive(Debug, Clone)]
pub(in crate::contact::colliders) struct SharpEdges {
    pub(super) all: Vec<SharpEdge>,
    tree: Bvh,
}

impl SharpEdge {
    /// Its bounding box (m).
    #[inline]
    pub fn corners(&self) -> [Vec3; 2] {
        let [a, b] = self.ends;
        let around = Vec3::splat(self.radius);
        [a.min(b) - around, a.max(b) + around]
    }

    /// Distance of a point from it (m), negative inside.
    pub fn distance(&self, point: Vec3) -> f32 {
        let [a, b] = self.ends;
        let (offset, along) = (point - a, b - a);
        let t = (offset.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        // A line of zero length is its first end.
        let nearest = if t > 0.0 { along * t } else { Vec3::ZERO };
        offset.distance(nearest) - self.radius
    }
}

impl SharpEdges {
    pub fn of(all: Vec<SharpEdge>) -> Self {
        let boxes = all.iter().map(SharpEdge::corners);
        let leaves: Vec<Aabb> = boxes.map(|[low, high]| Aabb::new(low, high)).collect();
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
            all,
        }
    }

    /// The edge with an index.
    #[inline]
    pub fn get(&self, index: u32) -> &SharpEdge {
        &self.all[index as usize]
    }

    /// Visits the edges whose boxes overlap a box, with their indices, always in the same order; none of a surface with
    /// a radius of at least `smooth` (m).
    pub fn near(
        &self,
        [lower, upper]: [Vec3; 2],
        smooth: f32,
        mut visit: impl FnMut(u32, &SharpEdge),
    ) {
        let around = Aabb::new(lower, upper);
        for index in self.tree.intersect_aabb(&around) {
            let edge = self.get(index);
            if edge.round < smooth {
                visit(index, edge);
            }
        }
    }

    /// Distance of the nearest of these edges (m); infinite if none is within the given distance.
    pub fn distance(&self, point: Vec3, within: f32, smooth: f32) -> f32 {
        self.tree
            .find_best(
                within,
                |node: &BvhNode, _| node.aabb().distance_to_local_point(point, true),
                |index, _| {
                    let edge = self.get(index);
                    (edge.round < smooth).then(|| edge.distance(point).max(0.0))
                },
            )
            .map_or(f32::INFINITY, |(_, distance)| distance)
    }
}

/// A side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::contact::colliders) struct Side {
    /// Its vertices, the smaller first.
    pub vertices: [u32; 2],
    pub is_forward: bool,
    pub face: u32,
}

/// The sides of all triangles of a mesh, sorted by edge.
pub(in crate::contact::colliders) struct MeshEdges(Vec<Side>);

impl MeshEdges {
    pub fn of(triangles: &[[u32; 3]]) -> Self {
        let sides = triangles.iter().zip(0_u32..).flat_map(|(triangle, face)| {
            [(0, 1), (1, 2), (2, 0)].map(|(from, to)| {
                let (from, to) = (triangle[from], triangle[to]);
                Side {
                    vertices: [from.min(to), from.max(to)],
                    is_forward: from < to,
                    face,
                }
            })
        });
        let mut sides: Vec<Side> = sides.collect();
        sides.sort_unstable();
        Self(sides)
    }

    /// The sides of each edge.
    pub fn edges(&self) -> impl Iterator<Item = &[Side]> {
        self.0.chunk_by(|a, b| a.vertices == b.vertices)
    }

    /// Whether the mesh is closed: each edge has two triangles of opposite directions.
    pub fn are_closed(&self) -> bool {
        self.edges()
            .all(|sides| matches!(sides, [a, b] if a.is_forward != b.is_forward))
    }

    /// The sharp edges; only convex ones for a mesh with an inner side.
    pub fn sharp(
        &self,
        vertices: &[Vec3],
        triangles: &[[u32; 3]],
        has_inside: bool,
    ) -> Vec<SharpEdge> {
        let corners = |face: u32| triangles[face as usize].map(|vertex| vertices[vertex as usize]);
        let normal = |face: u32| {
            let [a, b, c] = corners(face);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let is_tip = tips(vertices.len(), triangles, normal);
        let sharp = self.edges().filter_map(|sides| {
            let ends = sides[0].vertices.map(|vertex| vertices[vertex as usize]);
            let edge = |outward, part| SharpEdge {
                ends,
                outward,
                radius: 0.0,
                round: 0.0,
                part,
            };
            let [a, b] = sides else {
                // A border, or an edge where several sheets meet.
                return Some(edge(Vec3::ZERO, 1.0));
            };
            let mut normals = [normal(a.face), normal(b.face)];
            if a.is_forward == b.is_forward {
                normals[1] = -normals[1];
            }
            let across = normals[0].cross(normals[1]);
            // Two faces folded onto each other are not flat.
            if across.length() < SHARP && normals[0].dot(normals[1]) > 0.0 {
                return None;
            }
            if !has_inside {
                return Some(edge(Vec3::ZERO, 1.0));
            }
            // At a convex edge, the other face lies behind this one.
            let beyond = corners(b.face).map(|corner| normals[0].dot(corner - ends[0]));
            let sticks_out = beyond.iter().sum::<f32>() < 0.0;
            let outward = (normals[0] + normals[1]).normalize_or_zero();
            let sine = normals[0].distance(normals[1]) / 2.0;
            let ends_in_tip = sides[0].vertices.iter().any(|&end| is_tip[end as usize]);
            let part = match ends_in_tip {
                true => 1.0,
                false => (sine / SHARP_ENOUGH).clamp(LEAST_PART, 1.0),
            };
            sticks_out.then(|| edge(outward, part))
        });
        sharp.collect()
    }
}

/// Which vertices are tips: a face there is turned from the mean normal of all by more than 45°.
fn tips(vertices: usize, triangles: &[[u32; 3]], normal: impl Fn(u32) -> Vec3) -> Vec<bool> {
    let mut means = vec![Vec3::ZERO; vertices];
    for (face, corners) in (0..).zip(triangles) {
        for &corner in corners {
            means[corner as usize] += normal(face);
        }
    }
    let mut is_tip = vec![false; vertices];
    for (face, corners) in (0..).zip(triangles) {
        for &corner in corners {
            let mean = means[corner as usize].normalize_or_zero();
            is_tip[corner as usize] |= mean.dot(normal(face)) < FRAC_1_SQRT_2;
        }
    }
    is_tip
}
